// SPDX-License-Identifier: Apache-2.0
// The moment that is shown: slider, keys, playing, and what follows it.

const slider = document.getElementById('slider');
const player = {i: 0, playing: false, last_ms: 0, t_s: 0};

function pair(list, name, text, kind, key) {
  const box = document.createElement('div');
  const term = document.createElement('dt');
  const value = document.createElement('dd');
  term.textContent = name;
  value.textContent = text;
  if (kind) value.className = kind;
  if (key) value.dataset.key = key;
  box.append(term, value);
  list.append(box);
  return value;
}

function fillHeader() {
  document.title = `hardpack: ${run.world}, seed ${run.seed}: ${run.outcome}`;
  document.getElementById('title').textContent = `hardpack: ${run.world}, seed ${run.seed}`;
  document.getElementById('what').textContent = `A simulated mission of the onboard program's loop: ` +
    `${scene.description} Wanted: ${mission.wanted}. Speeds up to ${mission.max_speed_mps} m/s.`;
  const facts = document.getElementById('facts');
  for (const [key, name, text, kind] of factsOfRun()) pair(facts, name, text, kind, key);
}

function fillEvents() {
  const list = document.getElementById('events');
  for (const event of events) {
    const entry = document.createElement('li');
    const button = document.createElement('button');
    button.type = 'button';
    const time = document.createElement('span');
    const text = document.createElement('span');
    time.textContent = event.t_s.toFixed(2) + ' s';
    text.textContent = event.text;
    button.append(time, text);
    button.addEventListener('click', () => {
      pause();
      goToTime(event.t_s);
    });
    entry.append(button);
    list.append(entry);
  }
}

function fillLegend() {
  const entry = (picture, text) => {
    const item = document.createElement('li');
    item.innerHTML = picture;
    item.append(text);
    document.getElementById('legend').append(item);
  };
  const box = (colour) => '<svg width="16" height="12" aria-hidden="true"><rect x="0.5" y="0.5" ' +
    `width="15" height="11" fill="${colour}" stroke="#555"/></svg>`;
  const cell = (kind) => `rgba(${kColours.cells[kind].slice(0, 3).join(',')},0.85)`;
  const thick = (colour) => '<svg width="24" height="10" aria-hidden="true"><line x1="0" y1="5" x2="24" ' +
    `y2="5" stroke="#4d4600" stroke-width="7"/><line x1="0" y1="5" x2="24" y2="5" stroke="${colour}" ` +
    'stroke-width="4"/></svg>';
  const round = (colour) => '<svg width="14" height="14" aria-hidden="true"><circle cx="7" cy="7" r="6" ' +
    `fill="${colour}" stroke="#111"/></svg>`;
  entry(thick(kColours.driven), 'driven');
  entry(swatch(kColours.plan), 'plan');
  entry(swatch(kColours.earlier), 'earlier plans');
  entry(round(kColours.goal), 'goal');
  entry(round('#fff'), 'start');
  const kinds = new Set(scene.bodies.map((body) => body.kind));
  const names = {solid: 'solid', trunk: 'trunk', mesh: 'wire mesh', leaves: 'leaves'};
  for (const kind of Object.keys(names)) if (kinds.has(kind)) entry(box(kColours[kind]), names[kind]);
  if (scene.ditches.length > 0) entry(box(kColours.ditch), 'ditch');
  if (count > 0 && samples.people[0].length > 0) entry(round(kColours.person), 'person');
  entry(box(cell(1)), 'map: seen, free');
  entry(box(cell(2)), 'costs');
  entry(box(cell(3)), 'closed');
  entry(box(cell(4)), 'soft');
  entry(box(cell(5)), 'hard');
}

function show(i) {
  player.i = Math.max(0, Math.min(count - 1, i));
  slider.value = player.i;
  const t_s = samples.t_s[player.i] ?? 0;
  document.getElementById('clock').textContent = t_s.toFixed(2) + ' s';
  if (document.getElementById('follow').checked && count > 0) {
    view.x_m = samples.x_m[player.i];
    view.y_m = samples.y_m[player.i];
  }
  drawGround(t_s);
  drawLive(player.i);
  drawPlots(player.i);
  const now = document.getElementById('now');
  now.replaceChildren();
  if (count > 0) for (const [name, text] of factsAt(player.i)) pair(now, name, text, '', '');
  const last = lastBy(events, t_s);
  [...document.getElementById('events').children].forEach((entry, k) => {
    entry.className = k === last ? 'last' : k < last ? 'past' : '';
  });
}

// The sample nearest to a time.
function goToTime(t_s) {
  let best = 0;
  for (let i = 1; i < count; ++i) {
    if (Math.abs(samples.t_s[i] - t_s) < Math.abs(samples.t_s[best] - t_s)) best = i;
  }
  show(best);
}

function pause() {
  player.playing = false;
  document.getElementById('play').textContent = '\u25B6';
}

function play() {
  if (player.i >= count - 1) show(0);
  player.playing = true;
  player.last_ms = performance.now();
  player.t_s = samples.t_s[player.i] ?? 0;
  document.getElementById('play').textContent = '\u275A\u275A';
  requestAnimationFrame(advance);
}

function advance(now_ms) {
  if (!player.playing) return;
  const pace = Number(document.getElementById('pace').value);
  player.t_s += Math.max(0, now_ms - player.last_ms) / 1000 * pace;
  player.last_ms = now_ms;
  let i = player.i;
  while (i + 1 < count && samples.t_s[i + 1] <= player.t_s) ++i;
  if (i !== player.i) show(i);
  if (i >= count - 1) pause(); else requestAnimationFrame(advance);
}

function step(by) {
  pause();
  show(player.i + by);
}

// The next or the last time at which a plan was committed.
function stepPlan(by) {
  const now = lastBy(plans, samples.t_s[player.i] ?? 0);
  const next = plans[Math.max(0, Math.min(plans.length - 1, now + by))];
  if (!next) return;
  pause();
  const i = samples.t_s.findIndex((t_s) => t_s >= next.t_s - 1e-6);
  show(i < 0 ? count - 1 : i);
}

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === 'SELECT') return;
  const by = event.shiftKey ? 20 : 1;
  const acts = {
    ' ': () => (player.playing ? pause() : play()), 'ArrowLeft': () => step(-by),
    'ArrowRight': () => step(by), 'Home': () => step(-count), 'End': () => step(count),
    'n': () => stepPlan(1), 'p': () => stepPlan(-1), 'N': () => stepPlan(1), 'P': () => stepPlan(-1),
  };
  if (!acts[event.key]) return;
  event.preventDefault();
  acts[event.key]();
}

function zoom(by, px, py) {
  const before = [view.x_m + (px - view.width / 2) / view.scale,
    view.y_m - (py - view.height / 2) / view.scale];
  view.scale = Math.max(1, Math.min(400, view.scale * by));
  view.x_m = before[0] - (px - view.width / 2) / view.scale;
  view.y_m = before[1] + (py - view.height / 2) / view.scale;
  show(player.i);
}

// One finger or the mouse moves the map, two fingers zoom.
function listenToMap() {
  const held = new Map();
  const place = (event) => [event.offsetX, event.offsetY];
  liveCanvas.addEventListener('pointerdown', (event) => {
    liveCanvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, place(event));
  });
  for (const name of ['pointerup', 'pointercancel']) {
    liveCanvas.addEventListener(name, (event) => held.delete(event.pointerId));
  }
  liveCanvas.addEventListener('pointermove', (event) => {
    const before = held.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    const other = [...held.entries()].find(([id]) => id !== event.pointerId)?.[1];
    held.set(event.pointerId, now);
    if (other) {
      const apart = (a) => Math.hypot(a[0] - other[0], a[1] - other[1]);
      zoom(apart(now) / Math.max(apart(before), 1), ...other);
      return;
    }
    document.getElementById('follow').checked = false;
    view.x_m -= (now[0] - before[0]) / view.scale;
    view.y_m += (now[1] - before[1]) / view.scale;
    show(player.i);
  });
  liveCanvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 400), ...place(event));
  }, {passive: false});
}

function listen() {
  slider.max = Math.max(0, count - 1);
  slider.addEventListener('input', () => {
    pause();
    show(Number(slider.value));
  });
  document.addEventListener('keydown', onKey);
  const onClick = (id, act) => document.getElementById(id).addEventListener('click', (event) => {
    event.currentTarget.blur();  // or space would press it again
    act();
  });
  onClick('play', () => (player.playing ? pause() : play()));
  onClick('zoom_in', () => zoom(1.5, view.width / 2, view.height / 2));
  onClick('zoom_out', () => zoom(1 / 1.5, view.width / 2, view.height / 2));
  onClick('whole', () => {
    document.getElementById('follow').checked = false;
    showWhole();
    show(player.i);
  });
  for (const id of ['show_map', 'show_world', 'show_plans', 'follow']) {
    document.getElementById(id).addEventListener('change', (event) => {
      event.currentTarget.blur();
      if (id === 'follow' && event.currentTarget.checked) view.scale = Math.max(view.scale, 25);
      show(player.i);
    });
  }
  for (const canvas of plotCanvases.slice(0, kPlots.length)) {
    const go = (event) => {
      const width = canvas.clientWidth - kPlotFrame.left - kPlotFrame.right;
      pause();
      goToTime((event.offsetX - kPlotFrame.left) / width * timeRange()[1]);
    };
    canvas.addEventListener('pointerdown', go);
    canvas.addEventListener('pointermove', (event) => (event.buttons & 1) && go(event));
  }
  listenToMap();
  let width = window.innerWidth;
  window.addEventListener('resize', () => {
    if (window.innerWidth !== width) showWhole();  // a phone's address bar only changes the height
    width = window.innerWidth;
    show(player.i);
  });
}

fillHeader();
fillEvents();
makePlots();
fillLegend();
listen();
showWhole();
show(0);
