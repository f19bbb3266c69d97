// SPDX-License-Identifier: Apache-2.0
// Plots over time with one time axis for all, and the histogram of the reaction radius.

const kPlotFrame = {left: 44, right: 10, top: 6, bottom: 20};

// [title, unit, [[name, colour, value of a sample, dash, width]...], least and most that is always shown]
const kPlots = [
  ['Speed', 'm/s', [
    ['planned', kColours.planned, (i) => samples.planned_mps[i], null, 5],
    ['commanded', kColours.commanded, (i) => samples.commanded_mps[i], [2, 2]],
    ['driven', kColours.measured, (i) => samples.speed_mps[i]]], [0, 1]],
  ['Yaw rate', 'rad/s', [
    ['commanded', kColours.commanded, (i) => samples.commanded_yaw_radps[i], [2, 2]],
    ['driven', kColours.measured, (i) => samples.yaw_rate_radps[i]]], [-0.2, 0.2]],
  ['Curvature', '1/m', [
    ['commanded', kColours.commanded, (i) => samples.commanded_curvature_per_m[i], [2, 2]],
    ['driven, above 0.5 m/s', kColours.measured, drivenCurvature]], [-0.1, 0.1]],
  ['Reaction radius of the last second, cut at 2', 'm', [
    ['p99', kColours.tail, (i) => Math.min(samples.reaction_p99_m[i], 2), [6, 3]],
    ['median', kColours.median, (i) => Math.min(samples.reaction_median_m[i], 2)]], [0, 0.2]],
  ['Cross-track error', 'm', [
    ['driven', kColours.measured, (i) => samples.cross_track_m[i]]], [0, 0.1]],
];

const plotCanvases = [];

function swatch(colour, dash, width) {
  const dashes = dash ? ` stroke-dasharray="${dash.join(' ')}"` : '';
  return `<svg width="24" height="10" aria-hidden="true"><line x1="0" y1="5" x2="24" y2="5" ` +
    `stroke="${colour}" stroke-width="${width || 2.5}"${dashes}/></svg>`;
}

function addPlot(title, legend, name) {
  const box = document.createElement('div');
  box.className = 'plot';
  const heading = document.createElement('h3');
  heading.textContent = title;
  for (const [text, colour, dash, width] of legend) {
    const entry = document.createElement('span');
    entry.innerHTML = swatch(colour, dash, width);
    entry.append(text);
    heading.append(entry);
  }
  const canvas = document.createElement('canvas');
  canvas.dataset.plot = name;
  box.append(heading, canvas);
  document.getElementById('plots').append(box);
  return canvas;
}

function makePlots() {
  for (const [title, unit, lines] of kPlots) {
    const legend = lines.map(([text, colour, , dash, width]) => [text, colour, dash, width]);
    plotCanvases.push(addPlot(`${title} [${unit}]`, legend, title));
  }
  plotCanvases.push(addPlot('Reaction radius of all lidar columns [m]: share of columns [%]',
    [['median ' + number(quantile(run.reaction_m, 0.5), 2, 'm'), kColours.median, null],
      ['p99 ' + number(quantile(run.reaction_m, 0.99), 2, 'm'), kColours.tail, [6, 3]]],
    'histogram'));
}

function plotRange(lines, always) {
  let [low, high] = always;
  for (let i = 0; i < count; ++i) {
    for (const [, , value] of lines) {
      const y = value(i);
      if (!Number.isFinite(y)) continue;
      low = Math.min(low, y);
      high = Math.max(high, y);
    }
  }
  const room = 0.06 * (high - low);
  return [low < 0 ? low - room : 0, high + room];
}

// The frame of a plot with grid and numbers; what maps values to its pixels.
function drawFrame(canvas, xRange, yRange, xUnit) {
  const [pen, width, height] = fit(canvas);
  const f = kPlotFrame;
  const x = (v) => f.left + (v - xRange[0]) / (xRange[1] - xRange[0]) * (width - f.left - f.right);
  const y = (v) => height - f.bottom - (v - yRange[0]) / (yRange[1] - yRange[0]) *
    (height - f.top - f.bottom);
  pen.font = '11px system-ui, sans-serif';
  pen.fillStyle = '#333';
  pen.strokeStyle = '#e2e2e2';
  pen.lineWidth = 1;
  const yStep = roundStep((yRange[1] - yRange[0]) / 4.5);
  pen.textAlign = 'right';
  for (let v = Math.ceil(yRange[0] / yStep) * yStep; v <= yRange[1]; v += yStep) {
    pen.beginPath();
    pen.moveTo(f.left, y(v));
    pen.lineTo(width - f.right, y(v));
    pen.strokeStyle = Math.abs(v) < yStep / 2 ? '#aaa' : '#e2e2e2';
    pen.stroke();
    pen.fillText(stepText(v, yStep), f.left - 5, y(v) + 4);
  }
  const xStep = roundStep((xRange[1] - xRange[0]) / Math.max(2, width / 90));
  pen.textAlign = 'center';
  pen.strokeStyle = '#e2e2e2';
  for (let v = Math.ceil(xRange[0] / xStep) * xStep; v <= xRange[1]; v += xStep) {
    pen.beginPath();
    pen.moveTo(x(v), f.top);
    pen.lineTo(x(v), height - f.bottom);
    pen.stroke();
    if (x(v) < width - f.right - 34) pen.fillText(stepText(v, xStep), x(v), height - 6);
  }
  pen.textAlign = 'right';
  pen.fillText(xUnit, width - f.right, height - 6);
  return {pen, x, y, width, height};
}

function timeRange() {
  return [0, Math.max(samples.t_s[count - 1] ?? 0, 0.1)];
}

function drawPlot(index, i) {
  const [, , lines, always] = kPlots[index];
  const {pen, x, y, height} = drawFrame(plotCanvases[index], timeRange(), plotRange(lines, always),
    't [s]');
  for (const [, colour, value, dash, width] of lines) {
    pen.beginPath();
    let open = false;
    for (let k = 0; k < count; ++k) {
      const v = value(k);
      if (Number.isFinite(v)) pen[open ? 'lineTo' : 'moveTo'](x(samples.t_s[k]), y(v));
      open = Number.isFinite(v);
    }
    pen.strokeStyle = colour;
    pen.lineWidth = width || 1.6;
    pen.setLineDash(dash || []);
    pen.stroke();
    pen.setLineDash([]);
  }
  if (count === 0) return;
  const now = x(samples.t_s[i]);
  pen.fillStyle = 'rgba(240,228,66,0.35)';
  pen.fillRect(now - 3, kPlotFrame.top, 6, height - kPlotFrame.top - kPlotFrame.bottom);
  pen.fillStyle = '#4d4600';
  pen.fillRect(now - 0.5, kPlotFrame.top, 1, height - kPlotFrame.top - kPlotFrame.bottom);
  for (const [, colour, value] of lines) {
    if (!Number.isFinite(value(i))) continue;
    pen.beginPath();
    pen.arc(now, y(value(i)), 3, 0, 2 * Math.PI);
    pen.fillStyle = colour;
    pen.fill();
  }
}

function drawHistogram() {
  const {bins, beyond, width} = run.reaction_m;
  const canvas = plotCanvases[kPlots.length];
  const all = bins.reduce((sum, [, n]) => sum + n, beyond);
  const last = bins.length ? bins[bins.length - 1][0] + 2 : 10;
  const most = bins.reduce((peak, [, n]) => Math.max(peak, n), 1);
  const {pen, x, y, height} = drawFrame(canvas, [0, Math.max(last, 20) * width],
    [0, 108 * most / Math.max(all, 1)], 'r [m]');
  pen.fillStyle = '#8fb8d4';
  for (const [bin, n] of bins) {
    const left = x(bin * width);
    pen.fillRect(left, y(100 * n / all), Math.max(1, x((bin + 1) * width) - left - 0.5),
      y(0) - y(100 * n / all));
  }
  for (const [share, colour, dash] of [[0.5, kColours.median, []], [0.99, kColours.tail, [6, 3]]]) {
    const at = quantile(run.reaction_m, share);
    if (!Number.isFinite(at)) continue;
    pen.beginPath();
    pen.moveTo(x(at), kPlotFrame.top);
    pen.lineTo(x(at), height - kPlotFrame.bottom);
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.setLineDash(dash);
    pen.stroke();
  }
  pen.setLineDash([]);
}

function drawPlots(i) {
  for (let index = 0; index < kPlots.length; ++index) drawPlot(index, i);
  drawHistogram();
}
