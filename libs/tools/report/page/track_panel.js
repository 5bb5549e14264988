// SPDX-License-Identifier: BSD-3-Clause
// What is known of the selected track: its speed, its predictions against what came, its class.
'use strict';

const kHorizons = [1, 2, 3];  // [s]
const kHorizonColours = ['#35b779', '#f0b429', '#e8603c'];

function element(kind, text, style) {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  if (style) made.className = style;
  return made;
}

class TrackPanel {
  constructor(replay) {
    this.replay = replay;
    this.panel = byId('track');
    this.number = null;
  }

  select(number) {
    this.number = number;
    this.panel.hidden = number === null;
    document.body.classList.toggle('selected', number !== null);
    if (number === null) return;
    const track = this.replay.tracks[number];
    this.speeds = withGaps(track.states.map(({time, state}) => [time, state.speed]));
    this.errors = kHorizons.map((horizon) => predictionErrors(track, horizon));
    this.showErrors();
    this.showVotes(track);
  }

  /** A row of mean errors of each horizon. */
  showErrors() {
    const row = (kind, cells) => {
      const made = element('tr');
      made.append(...cells.map((cell) => element(kind, cell)));
      return made;
    };
    const mean = (errors) => errors.length ?
        `${(errors.reduce((sum, [, e]) => sum + e, 0) / errors.length).toFixed(2)} m` : '–';
    const head = row('th', ['ahead', ...kHorizons.map((horizon) => `${horizon} s`)]);
    [...head.children].slice(1).forEach((cell, i) => cell.style.setProperty('color', kHorizonColours[i]));
    byId('errors').replaceChildren(
        head, row('td', ['mean error', ...this.errors.map(mean)]),
        row('td', ['predictions', ...this.errors.map((errors) => String(errors.length))]));
  }

  showVotes(track) {
    const total = Object.values(track.votes).reduce((sum, count) => sum + count, 0);
    const votes = Object.entries(track.votes).sort(([, a], [, b]) => b - a);
    byId('votes').replaceChildren(...votes.map(([kind, count]) => {
      const row = element('div', undefined, 'vote');
      const meter = element('meter');
      meter.max = total;
      meter.value = count;
      row.append(element('span', this.replay.classes[kind][0]), meter, element('output', String(count)));
      return row;
    }));
  }

  update(moment, colours) {
    if (this.number === null) return;
    const {states} = this.replay.tracks[this.number];
    const now = moment.tracks.find((state) => state.number === this.number);
    const {state} = now ? {state: now} : states[lastNotAbove(states, ({time}) => time, moment.time)];
    this.panel.querySelector('h2').textContent = `${state.class} ${state.id}`;
    this.panel.querySelector('.dot').style.setProperty('background', state.colour);
    this.panel.querySelector('.state').textContent = now ?
        `${now.speed.toFixed(1)} m/s · ${now.moving ? 'moving' : 'static'}` +
            `${now.coasting ? ' · not detected, predicted' : ''} · ${now.length.toFixed(1)} × ` +
            `${now.width.toFixed(1)} × ${now.height.toFixed(1)} m` :
        `seen from ${clockText(states[0].time)} to ${clockText(states[states.length - 1].time)}`;
    const range = {low: states[0].time, high: states[states.length - 1].time, cursor: moment.time, colours};
    drawChart(byId('speed-chart'), {...range, lines: [{points: this.speeds, colour: colours.accent}]});
    drawChart(byId('error-chart'), {...range, lines: this.errors.map((points, i) => (
        {points: withGaps(points), colour: kHorizonColours[i]}))});
  }
}
