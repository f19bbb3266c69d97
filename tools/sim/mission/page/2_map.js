// SPDX-License-Identifier: Apache-2.0
// The world from above: a canvas with what does not depend on the moment but its costmap, and one
// over it with what does. Equal scales on both axes.

const view = {scale: 10, x_m: 0, y_m: 0, width: 0, height: 0};  // pixels a metre; the middle
const groundCanvas = document.getElementById('ground');
const liveCanvas = document.getElementById('live');
const toPx = (p) => [view.width / 2 + (p[0] - view.x_m) * view.scale,
  view.height / 2 - (p[1] - view.y_m) * view.scale];

function fit(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const pen = canvas.getContext('2d');
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return [pen, width, height];
}

function showWhole() {
  const [left, low, right, high] = scene.focus;
  view.x_m = (left + right) / 2;
  view.y_m = (low + high) / 2;
  view.scale = Math.min(groundCanvas.clientWidth / (right - left),
    groundCanvas.clientHeight / (high - low));
}

// Shades of the ground: higher is lighter, lit from the upper left.
function imageOfHeights() {
  const {columns, rows, cm} = scene.heights;
  const image = new ImageData(columns, rows);
  let least = Infinity;
  let most = -Infinity;
  for (const one of cm) {
    least = Math.min(least, one);
    most = Math.max(most, one);
  }
  const span = Math.max(most - least, 100);
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const at = row * columns + column;
      const east = cm[column + 1 < columns ? at + 1 : at];
      const north = cm[row + 1 < rows ? at + columns : at];
      const light = Math.max(-38, Math.min(38, 0.7 * ((east - cm[at]) - (north - cm[at]))));
      const share = (cm[at] - least) / span;
      const px = 4 * ((rows - 1 - row) * columns + column);
      image.data.set([168 + 50 * share + light, 174 + 40 * share + light, 160 + 36 * share + light,
        255], px);
    }
  }
  return canvasOf(image);
}

function canvasOf(image) {
  const canvas = document.createElement('canvas');
  canvas.width = image.width;
  canvas.height = image.height;
  canvas.getContext('2d').putImageData(image, 0, 0);
  return canvas;
}

// A costmap as a picture, its first row below.
function imageOfMap(map) {
  const image = new ImageData(Math.max(1, map.columns), Math.max(1, map.rows));
  let at = 0;
  for (const [, letter, times] of map.cells.matchAll(/([a-g])(\d+)/g)) {
    const colour = kColours.cells[letter.charCodeAt(0) - 97];
    for (let left = Number(times); left > 0; --left, ++at) {
      const row = map.rows - 1 - Math.floor(at / map.columns);
      if (colour) image.data.set(colour, 4 * (row * map.columns + at % map.columns));
    }
  }
  return canvasOf(image);
}

const pictures = {heights: null, maps: new Map()};
function pictureOfMap(index) {
  if (!pictures.maps.has(index)) pictures.maps.set(index, imageOfMap(maps[index]));
  return pictures.maps.get(index);
}

function line(pen, points, colour, width, dash) {
  if (points.length < 2) return;
  pen.beginPath();
  points.forEach((point, i) => pen[i ? 'lineTo' : 'moveTo'](...toPx(point)));
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash || []);
  pen.lineJoin = 'round';
  pen.lineCap = dash ? 'butt' : 'round';
  pen.stroke();
  pen.setLineDash([]);
}

function disc(pen, at, radius_px, fill, rim) {
  pen.beginPath();
  pen.arc(...toPx(at), Math.max(radius_px, 1.5), 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  if (rim) {
    pen.strokeStyle = rim;
    pen.lineWidth = 1.2;
    pen.stroke();
  }
}

function drawBody(pen, body) {
  pen.beginPath();
  if (body.corners) {
    body.corners.forEach((corner, i) => pen[i ? 'lineTo' : 'moveTo'](...toPx(corner)));
    pen.closePath();
  } else {
    pen.arc(...toPx(body.at), Math.max(body.radius_m * view.scale, 1), 0, 2 * Math.PI);
  }
  pen.fillStyle = kColours[body.kind];
  pen.fill();
  pen.strokeStyle = body.kind === 'leaves' ? 'rgba(0,90,65,0.55)' : 'rgba(0,0,0,0.7)';
  if (body.kind === 'mesh') pen.strokeStyle = kColours.mesh;
  pen.lineWidth = body.kind === 'mesh' ? 2 : 1;
  pen.stroke();
}

function drawCostmap(pen, map, picture) {
  pen.save();
  pen.translate(...toPx(map.at));
  pen.rotate(-map.yaw_rad);
  const px = mission.cell_m * view.scale;
  pen.imageSmoothingEnabled = false;
  pen.drawImage(picture, 0, -map.rows * px, map.columns * px, map.rows * px);
  pen.restore();
}

// Round steps of 1, 2 or 5 times a power of ten, at least so far apart.
function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= least * 0.999);
}
function stepText(value, step) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return (Math.abs(value) < step / 2 ? 0 : value).toFixed(digits);
}

function drawAxes(pen) {
  const step = roundStep(60 / view.scale);
  pen.font = '11px system-ui, sans-serif';
  const label = (text, x, y, align) => {
    pen.textAlign = align;
    pen.lineWidth = 3;
    pen.strokeStyle = 'rgba(255,255,255,0.85)';
    pen.strokeText(text, x, y);
    pen.fillStyle = '#222';
    pen.fillText(text, x, y);
  };
  const ends = [view.x_m - view.width / 2 / view.scale, view.x_m + view.width / 2 / view.scale,
    view.y_m - view.height / 2 / view.scale, view.y_m + view.height / 2 / view.scale];
  const rule = (x1, y1, x2, y2) => {
    pen.beginPath();
    pen.moveTo(x1, y1);
    pen.lineTo(x2, y2);
    pen.strokeStyle = 'rgba(60,60,80,0.16)';
    pen.lineWidth = 1;
    pen.stroke();
  };
  const marks = [];
  for (let x = Math.ceil(ends[0] / step) * step; x <= ends[1]; x += step) {
    const px = toPx([x, 0])[0];
    rule(px, 0, px, view.height);
    if (px > 40 && px < view.width - 60) marks.push([stepText(x, step), px, view.height - 5, 'center']);
  }
  for (let y = Math.ceil(ends[2] / step) * step; y <= ends[3]; y += step) {
    const px = toPx([0, y])[1];
    rule(0, px, view.width, px);
    if (px > 24 && px < view.height - 20) marks.push([stepText(y, step), 5, px + 4, 'left']);
  }
  for (const mark of marks) label(...mark);
  label('x [m]', view.width - 6, view.height - 5, 'right');
  label('y [m]', 5, 14, 'left');
}

function drawGround(t_s) {
  const [pen, width, height] = fit(groundCanvas);
  view.width = width;
  view.height = height;
  pen.fillStyle = '#d9d9d4';
  pen.fillRect(0, 0, width, height);
  pictures.heights ??= imageOfHeights();
  const {columns, rows, step_m} = scene.heights;
  const [left, low] = scene.extent;
  const corner = toPx([left - step_m / 2, low - step_m / 2 + rows * step_m]);
  pen.drawImage(pictures.heights, ...corner, columns * step_m * view.scale, rows * step_m * view.scale);
  for (const ditch of scene.ditches) {
    line(pen, [ditch.from, ditch.to], kColours.ditch, 2 * ditch.half_width_m * view.scale, [1e9]);
  }
  const map = lastBy(maps, t_s);
  const showsMap = document.getElementById('show_map').checked;
  if (showsMap && map >= 0) drawCostmap(pen, maps[map], pictureOfMap(map));
  drawAxes(pen);
  if (!document.getElementById('show_world').checked) return;
  for (const leaves of [false, true]) {
    for (const body of scene.bodies) if ((body.kind === 'leaves') === leaves) drawBody(pen, body);
  }
}

// The outline of the vehicle, its nose first.
function outlineAt(i) {
  const [x, y, yaw] = [samples.x_m[i], samples.y_m[i], samples.yaw_rad[i]];
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const {length_m, width_m, middle_m} = mission.vehicle;
  return [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]].map(([a, b]) => {
    const ahead_m = middle_m + a * length_m;
    return [x + c * ahead_m - s * b * width_m, y + s * ahead_m + c * b * width_m];
  });
}

function drawVehicle(pen, i) {
  const corners = outlineAt(i).map(toPx);
  pen.beginPath();
  corners.forEach((corner, k) => pen[k ? 'lineTo' : 'moveTo'](...corner));
  pen.closePath();
  pen.fillStyle = 'rgba(255,255,255,0.8)';
  pen.fill();
  pen.strokeStyle = kColours.vehicle;
  pen.lineWidth = 2;
  pen.stroke();
  pen.beginPath();  // an arrow in it
  const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  pen.moveTo(...middle(corners[0], corners[3]));
  pen.lineTo(...corners[1]);
  pen.lineTo(...corners[2]);
  pen.closePath();
  pen.fillStyle = kColours.vehicle;
  pen.fill();
}

function drawLive(i) {
  const [pen] = fit(liveCanvas);
  const t_s = samples.t_s[i] ?? 0;
  const now = lastBy(plans, t_s);
  if (document.getElementById('show_plans').checked) {
    plans.forEach((plan) => line(pen, plan.path, kColours.earlier, 1.2));
  } else {
    for (let k = Math.max(0, now - 3); k < now; ++k) line(pen, plans[k].path, kColours.earlier, 2);
  }
  const way = [];
  for (let k = 0; k <= i && k < count; ++k) way.push([samples.x_m[k], samples.y_m[k]]);
  if (now >= 0) line(pen, plans[now].path, '#ffffff', 5.5);
  if (now >= 0) line(pen, plans[now].path, kColours.plan, 3);
  // On top, as a plan that is kept to lies under it. Yellow, as the paper has it; with a rim, or it
  // is not seen on light ground.
  line(pen, way, '#4d4600', 6.5);
  line(pen, way, kColours.driven, 4);
  disc(pen, scene.start, 5, '#ffffff', kColours.vehicle);
  disc(pen, scene.goal, 8, kColours.goal, '#111');
  disc(pen, scene.goal, 3, '#fff', null);
  if (count > 0) {
    for (const person of samples.people[i]) {
      disc(pen, person, 0.3 * view.scale + 1, kColours.person, '#fff');
    }
    drawVehicle(pen, i);
  }
}
