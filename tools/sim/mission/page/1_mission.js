// SPDX-License-Identifier: Apache-2.0
// The data of the page, and what is told from them: no drawing here. The scripts of this folder are
// joined in the order of their names, and share this scope.
'use strict';

const mission = JSON.parse(document.getElementById('data').textContent);
const {run, scene, samples, plans, maps, events} = mission;
const count = samples.t_s.length;

// Colours that are told apart by the colour-blind too (Okabe and Ito), and the paper's yellow.
const kColours = {
  driven: '#f0e442', plan: '#0072b2', earlier: 'rgba(0,114,178,0.22)', vehicle: '#111111',
  goal: '#cc79a7', person: '#7b1fa2', measured: '#111111', commanded: '#d55e00', planned: '#8cc8ec',
  median: '#0072b2', tail: '#d55e00', solid: '#5f6368', trunk: '#6b4a2b', leaves: 'rgba(0,158,115,0.30)',
  mesh: '#3f51b5', ditch: 'rgba(90,70,40,0.35)',
  // By the kinds of cells: unknown, free, costly, lethal, soft, hard, a person.
  cells: [null, [255, 255, 255, 150], [230, 200, 140, 150], [213, 130, 60, 150], [0, 158, 115, 190],
    [150, 20, 10, 235], [123, 31, 162, 255]],
};

// The last of a list of things with times that is not later; -1: none is.
function lastBy(list, t_s) {
  let low = 0;
  let high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle].t_s <= t_s + 1e-6) low = middle + 1; else high = middle;
  }
  return low - 1;
}

// The smallest upper edge of a bin up to which that share of a histogram lies (docs/simulation.md).
function quantile(histogram, share) {
  let all = histogram.beyond;
  for (const [, n] of histogram.bins) all += n;
  let found = 0;
  for (const [bin, n] of histogram.bins) {
    found += n;
    if (found >= share * all) return (bin + 1) * histogram.width;
  }
  return all > 0 ? Infinity : 0;
}

function number(value, digits, unit) {
  return Number.isFinite(value) ? value.toFixed(digits) + (unit ? '\u00a0' + unit : '') : 'beyond';
}

// Facts of the whole run: [key of run.json or '', name, text, 'good' / 'bad' / 'code' / ''].
function factsOfRun() {
  const reaction = run.reaction_m;
  const facts = [
    ['outcome', 'outcome', run.outcome + (run.outcome !== 'reached' && run.reason !== 'none' ? ': ' + run.reason : ''),
      run.success ? 'good' : 'bad'],
    ['time_s', 'time', number(run.time_s, 2, 's'), ''],
    ['driven_m', 'driven', number(run.driven_m, 2, 'm'), ''],
    ['max_speed_mps', 'fastest', number(run.max_speed_mps, 2, 'm/s'), ''],
    ['clearance_m', 'least clearance', number(run.clearance_m, 2, 'm'), ''],
    ['cross_track_p95_m', 'cross-track p95', number(quantile(run.cross_track_m, 0.95), 3, 'm'), ''],
    ['reaction_median_m', 'reaction radius, median', number(quantile(reaction, 0.5), 2, 'm'), ''],
    ['reaction_p99_m', 'p99', number(quantile(reaction, 0.99), 2, 'm'), ''],
    ['jerk_rms_mps3', 'jerk (rms)', number(run.jerk_rms_mps3, 2, 'm/s\u00b3'), ''],
    ['replans', 'replans', String(run.replans), ''],
    ['stops', 'stops', String(run.stops), ''],
    ['world', 'world', run.world, ''],
    ['seed', 'seed', String(run.seed), ''],
    ['vehicle', 'vehicle', run.vehicle, ''],
    ['planner', 'planner, tracker', run.planner + ', ' + run.tracker, ''],
    ['decision_hash', 'decision hash', run.decision_hash, 'code'],
  ];
  const replay = run.replayed ? 'replayed, every tick the same'
    : mission.has_log ? 'written, not replayed' : 'none';
  facts.push(['replayed', 'log', replay, run.replayed ? 'good' : '']);
  return facts;
}

// Facts of a moment: [name, text].
function factsAt(i) {
  const at = (name) => samples[name][i];
  const event = lastBy(events, at('t_s'));
  return [
    ['mode', event < 0 ? '' : events[event].text],
    ['speed', number(at('speed_mps'), 2, 'm/s') +
      (at('commanded_mps') < 0 ? ', in reverse' : '')],
    ['of the plan', number(at('planned_mps'), 2, 'm/s')],
    ['yaw rate', number(at('yaw_rate_radps'), 2, 'rad/s')],
    ['cross-track error', number(at('cross_track_m'), 3, 'm')],
    ['clearance', number(at('clearance_m'), 2, 'm')],
    ['reaction radius', number(at('reaction_median_m'), 2, 'm') + ' / ' +
      number(at('reaction_p99_m'), 2, 'm')],
    ['plan', (lastBy(plans, at('t_s')) + 1) + ' of ' + plans.length],
    ['place', number(at('x_m'), 1, '') + ', ' + number(at('y_m'), 1, 'm')],
  ];
}

// Yaw rate over speed, where it is driven fast enough to be told.
function drivenCurvature(i) {
  const speed_mps = samples.speed_mps[i];
  return Math.abs(speed_mps) > 0.5 ? samples.yaw_rate_radps[i] / speed_mps : NaN;
}
