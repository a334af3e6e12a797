'use strict';

// Overlaid profiles of sections, as SVG: all drawings to one scale, the same along and across.

function curveStroke(i) {
  return i === 0 ? {class: 'reference'} : {stroke: PART_COLOURS[(i - 1) % PART_COLOURS.length]};
}

function rangeOf(points, axis) {
  const values = points.map(point => point[axis]);
  return [Math.min(...values), Math.max(...values)];
}

// The width of the widest drawing, which all others share.
function profileWidth(profiles, placing) {
  const widths = profiles.map(({curves}) => {
    const [min, max] = rangeOf(curves.flatMap(curve => curve[placing]), 0);
    return max - min;
  });
  return 1.01 * Math.max(...widths);
}

function profileDrawing({section, curves}, placing, names, width, step) {
  const points = curves.flatMap(curve => curve[placing]);
  const [left] = rangeOf(points, 0);
  const [low, high] = rangeOf(points, 1);
  const top = Math.ceil(high / step) * step, bottom = Math.min(0, Math.floor(low / step) * step);
  const svg = svgElement('svg', {
    viewBox: `${left - 0.005 * width} ${-top} ${width} ${Math.max(top - bottom, step)}`, role: 'img',
    'aria-label': `Profiles of ${section}`});
  for (let y = bottom; y <= top; y += step) {
    svg.append(svgElement('line', {x1: left, x2: left + 0.99 * width, y1: -y, y2: -y}));
  }
  for (let x = Math.ceil(left / step) * step; x <= left + 0.99 * width; x += step) {
    svg.append(svgElement('line', {x1: x, x2: x, y1: -top, y2: -bottom}));
  }
  // The reference lies on top: it is dashed, so that others show through.
  for (const curve of [...curves.slice(1), curves[0]]) {
    const i = names.indexOf(curve.name, curve === curves[0] ? 0 : 1);
    svg.append(svgElement('polyline', {
      ...curveStroke(i), points: curve[placing].map(([x, y]) => `${x},${-y}`).join(' ')},
      svgElement('title', {}, curve.name)));
  }
  return element('figure', {className: 'profile'}, element('h3', {textContent: section}), svg);
}

// `names`: of the reference and of the shapes.
function fillProfiles(profiles, names) {
  if (profiles.length === 0) return;
  byId('profiles').hidden = false;
  byId('curves').append(...names.map((name, i) => element('span', {},
      svgElement('svg', {viewBox: '0 0 34 10'},
          svgElement('line', {...curveStroke(i), x1: 0, x2: 34, y1: 5, y2: 5})), name)));
  const draw = () => {
    const placing = byId('placing').value;
    const width = profileWidth(profiles, placing);
    const step = roundUp(width / 20);
    byId('drawings').replaceChildren(
        ...profiles.map(profile => profileDrawing(profile, placing, names, width, step)).reverse());
    byId('grid').textContent = `From luff (left) to leech, to one scale; the grid is ${step} mm.`;
  };
  byId('placing').addEventListener('change', draw);
  draw();
}
