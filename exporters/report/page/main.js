'use strict';

// Reads the data, fills the page, and connects the controls of the 3D view.

// The first factor makes a typical ellipsoid as long as its marker.
function firstFactor(view) {
  const lengthOf = axis => Math.hypot(...axis);
  const known = view.markers.filter(({ellipsoid}) => ellipsoid && lengthOf(ellipsoid[2]) > 0);
  if (known.length === 0) return 0;
  const wanted = quantile(known.map(({ellipsoid, length_mm: length}) => length / 2000 / lengthOf(ellipsoid[2])), 0.5);
  return Math.max(0, FACTORS.filter(factor => factor <= wanted).length - 1);
}

function connectFactor(view) {
  const layer = view.layers.find(({key}) => key === 'ellipsoids');
  if (!layer) return;
  const input = byId('factor');
  Object.assign(input, {min: 0, max: FACTORS.length - 1, value: firstFactor(view)});
  const change = () => {
    byId('factor_value').textContent = FACTORS[input.value];
    layer.object.setFactor(FACTORS[input.value]);
    view.showLegend();
    view.render();
  };
  input.addEventListener('input', change);
  change();
  byId('factor_label').hidden = false;
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
  connectColours(view, colourings(view.markers));
  connectLayers(view);
  connectFactor(view);
  connectView(view);
  byId('show_all').addEventListener('click', () => view.showAll());
}

function main() {
  const data = JSON.parse(byId('data').textContent);
  byId('origin').textContent =
      [...data.origin, data.created && `computed ${data.created}`, `velamap ${data.version}`].filter(Boolean).join(' · ');
  fillVerdict(data.verdict);
  fillKeyNumbers(data.key_numbers);
  fillView(data);
  if (data.sections) fillSections(data);
  fillRigs(data.rigs);
  fillSurfaces(data);
  drawCharts(data);
  onTheme(() => drawCharts(data));
  fillPicture(data.picture);
  fillLeftOut(data);
  fillTables(data);
  document.documentElement.dataset.readyMs = Math.round(performance.now());
}

main();
