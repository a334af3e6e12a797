'use strict';

// Reads the data, fills the page, and connects the controls of the 3D view. The address can set the
// view: #azimuth=120&elevation=20&zoom=1.5&colour=error&ids=1

function hasWebGL() {
  const canvas = document.createElement('canvas');
  return Boolean(canvas.getContext('webgl2') || canvas.getContext('webgl'));
}

function connectColours(view) {
  const all = colourings(view.markers);
  const select = byId('colour');
  select.append(...all.map(({key, name}) => element('option', {value: key, textContent: name})));
  const change = () => view.colourBy(all.find(({key}) => key === select.value));
  select.addEventListener('change', change);
  change();
}

function connectLayers(view) {
  for (const layer of view.layers) {
    const label = checkBox(layer.name, layer.isOn, isOn => {
      layer.isOn = isOn;
      view.render();
    });
    layer.box = label.firstChild;
    byId('layers').append(label);
  }
  const ids = checkBox('ids', false, isOn => {
    view.idsAreOn = isOn;
    view.render();
  });
  ids.firstChild.id = 'ids';
  byId('layers').append(ids);
}

// The first factor makes a typical ellipsoid as wide as its marker.
function connectFactor(view) {
  const layer = view.layers.find(({key}) => key === 'ellipsoids');
  if (!layer) return;
  const ratios = view.markers.filter(marker => marker.sigma_mm > 0)
      .map(marker => 0.5 * marker.length_mm / marker.sigma_mm);
  const first = FACTORS.filter(factor => ratios.length && factor <= quantile(ratios, 0.5)).length - 1;
  const input = byId('factor');
  Object.assign(input, {min: 0, max: FACTORS.length - 1, value: Math.max(0, first)});
  const change = () => {
    byId('factor_value').textContent = FACTORS[input.value];
    layer.object.setFactor(FACTORS[input.value]);
    view.render();
  };
  input.addEventListener('input', change);
  change();
  byId('factor_label').hidden = false;
}

const VIEWS = {front: [0, 0], side: [90, 0], top: [0, 90]};
const KEYS = {
  ArrowLeft: [-10, 0, 1], ArrowRight: [10, 0, 1], ArrowUp: [0, 10, 1], ArrowDown: [0, -10, 1],
  '+': [0, 0, 1.2], '-': [0, 0, 1 / 1.2],
};

function connectView(view) {
  for (const button of document.querySelectorAll('[data-view]')) {
    button.addEventListener('click', () => view.setView(...VIEWS[button.dataset.view]));
  }
  byId('show_all').addEventListener('click', () => view.showAll());
  byId('save_view').addEventListener('click', () => savePicture(view.picture(), 'shape'));
  view.container.addEventListener('keydown', event => {
    if (!KEYS[event.key]) return;
    event.preventDefault();
    view.turn(...KEYS[event.key]);
  });
  byId('parallel').addEventListener('change', event => view.setParallel(event.target.checked));
  window.addEventListener('beforeprint', () => {
    byId('view_print').src = view.picture().toDataURL('image/png');
    const isFactor = view.layers.some(({key, isOn}) => key === 'ellipsoids' && isOn);
    byId('view_print_note').textContent = isFactor
        ? `Ellipsoids: 1 sigma, drawn ${byId('factor_value').textContent} times as large.` : '';
  });
  window.addEventListener('hashchange', () => followAddress(view));
  followAddress(view);
}

function followAddress(view) {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const number = (key, otherwise) =>
      wanted.has(key) && Number.isFinite(Number(wanted.get(key))) ? Number(wanted.get(key)) : otherwise;
  if (wanted.has('colour') && byId('colour').querySelector(`[value="${CSS.escape(wanted.get('colour'))}"]`)) {
    byId('colour').value = wanted.get('colour');
    byId('colour').dispatchEvent(new Event('change'));
  }
  if (wanted.has('ids') && byId('ids').checked !== (wanted.get('ids') === '1')) byId('ids').click();
  if (wanted.has('azimuth') || wanted.has('elevation') || wanted.has('zoom')) {
    view.setView(number('azimuth', 20), number('elevation', 15), Math.max(0.1, number('zoom', 1)));
  }
}

function fillView(data) {
  byId('frame').textContent = `Frame: ${data.frame.name}.`;
  if (!hasWebGL() || !data.markers.some(whole)) {
    const reason = hasWebGL() ? 'No marker is whole, so there is nothing to show.'
                              : 'This browser offers no WebGL, which the 3D view needs.';
    byId('view').prepend(element('p', {className: 'message', textContent: reason}));
    return;
  }
  const view = new View3D(data, byId('view'));
  onTheme(() => view.render());
  connectColours(view);
  connectLayers(view);
  connectFactor(view);
  connectView(view);
}

function main() {
  const data = JSON.parse(byId('data').textContent);
  byId('origin').textContent =
      [...data.origin, data.created, `velamap ${data.version}`].filter(Boolean).join(' · ');
  fillVerdict(data.verdict);
  fillKeyNumbers(data.key_numbers);
  fillView(data);
  if (data.sections) fillSections(data.sections);
  fillRigs(data.rigs);
  fillSurfaces(data.surfaces);
  drawCharts(data);
  onTheme(() => drawCharts(data));
  fillPicture(data.picture);
  fillLeftOut(data);
  fillTables(data);
  document.documentElement.dataset.readyMs = Math.round(performance.now());
}

main();
