'use strict';

// The controls of the 3D view. The address can set the view:
// #azimuth=120&elevation=20&zoom=1.5&colour=error&ids=1

function hasWebGL() {
  const canvas = document.createElement('canvas');
  return Boolean(canvas.getContext('webgl2') || canvas.getContext('webgl'));
}

// Offers `all` colourings for choice; they have the form of those in colours.js.
function connectColours(view, all) {
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
      view.showLegend();
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

const VIEWS = {front: [0, 0], side: [90, 0], top: [0, 90]};
const KEYS = {
  ArrowLeft: [-10, 0, 1], ArrowRight: [10, 0, 1], ArrowUp: [0, 10, 1], ArrowDown: [0, -10, 1],
  '+': [0, 0, 1.2], '-': [0, 0, 1 / 1.2],
};

function connectView(view) {
  onTheme(() => view.render());  // before the picture for the print is taken
  for (const button of document.querySelectorAll('[data-view]')) {
    button.addEventListener('click', () => view.setView(...VIEWS[button.dataset.view]));
  }
  byId('save_view').addEventListener('click', () => savePicture(view.picture(), 'shape'));
  byId('parallel').addEventListener('change', event => view.setParallel(event.target.checked));
  view.container.addEventListener('keydown', event => {
    if (!KEYS[event.key]) return;
    event.preventDefault();
    view.turn(...KEYS[event.key]);
  });
  window.addEventListener('beforeprint', () => {
    byId('view_print').src = view.picture().toDataURL('image/png');
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
