'use strict';

// Reads the data, fills the page, and connects the controls of the 3D view.

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
      [...data.origin, data.created, `velamap ${data.version}`].filter(Boolean).join(' · ');
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
