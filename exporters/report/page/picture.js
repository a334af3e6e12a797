'use strict';

// The central image with detected and reprojected corners (Figure 4.25 of the thesis).

const PICTURE_LAYERS = [
  {name: 'detected', colour: '#ffd500', checked: true},
  {name: 'reprojected', colour: '#00b7ff', checked: true},
  {name: 'error', colour: '#ff4fa3', checked: true},
  {name: 'rejected', colour: '#ff3b30', checked: true},
  {name: 'not detected', colour: '#b08cff', checked: true},
  {name: 'ids', colour: '#ffffff', checked: false},
];

const counted = (number, one, many) => `${number} ${number === 1 ? one : many}`;

// Factor that makes the larger error vectors visible.
function errorFactor(picture) {
  const lengths = picture.points.map(([, , , dx, dy]) => Math.hypot(dx, dy));
  const length = lengths.length ? quantile(lengths, 0.95) : 0;
  return length > 0 ? Math.max(1, roundUp(picture.width_px / 100 / length)) : 1;
}

function picturePaths(picture, factor) {
  const r = picture.width_px / 320;
  const paths = {detected: '', reprojected: '', error: ''};
  for (const [, x, y, dx, dy] of picture.points) {
    paths.detected += `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
    paths.reprojected += `M${x + dx - r} ${y + dy}h${2 * r}M${x + dx} ${y + dy - r}v${2 * r}`;
    paths.error += `M${x} ${y}l${factor * dx} ${factor * dy}`;
  }
  paths.rejected = picture.rejected.map(([x, y]) => `M${x - r} ${y - r}l${2 * r} ${2 * r}m0 ${-2 * r}l${-2 * r} ${2 * r}`).join('');
  paths['not detected'] = picture.not_detected
      .map(({corners}) => `M${corners.map(corner => corner.join(' ')).join('L')}Z`).join('');
  return paths;
}

// Markers with the means of their corners in the picture.
function pictureMarkers(picture) {
  const sums = new Map();
  const add = (id, x, y) => {
    const sum = sums.get(id) || {x: 0, y: 0, count: 0};
    sums.set(id, {x: sum.x + x, y: sum.y + y, count: sum.count + 1});
  };
  for (const [pointId, x, y] of picture.points) add(Math.floor(pointId / 10), x, y);
  for (const {id, corners} of picture.not_detected) corners.forEach(([x, y]) => add(id, x, y));
  return [...sums].map(([id, sum]) => ({id, x: sum.x / sum.count, y: sum.y / sum.count}));
}

// The ids beside their markers, with a line to those that are away from theirs.
function pictureIds(picture, size) {
  return freePlaces(pictureMarkers(picture), size).flatMap(({id, x, y, left, top}) => [
    svgElement('path', {d: `M${x} ${y}L${left} ${top}`, stroke: '#ffffff', 'stroke-width': size / 10}),
    svgElement('text', {x: left, y: top, 'text-anchor': 'middle', 'dominant-baseline': 'central'}, String(id)),
  ]);
}

function pictureLayer(layer, picture, paths) {
  const group = svgElement('g', layer.name === 'ids'
      ? {fill: layer.colour, stroke: '#000', 'stroke-width': picture.width_px / 500,
         'paint-order': 'stroke', 'font-size': picture.width_px / 85, 'font-family': 'sans-serif'}
      : {fill: 'none', stroke: layer.colour, 'stroke-width': picture.width_px / 1100});
  if (layer.name === 'ids') {
    group.append(...pictureIds(picture, picture.width_px / 85));
  } else {
    group.append(svgElement('path', {d: paths[layer.name]}));
  }
  return group;
}

function fillPicture(picture) {
  const factor = errorFactor(picture);
  const paths = picturePaths(picture, factor);
  const svg = svgElement('svg', {viewBox: `0 0 ${picture.width_px} ${picture.height_px}`,
                                 'aria-hidden': 'true'});
  if (!picture.jpeg) svg.append(svgElement('rect', {width: '100%', height: '100%', fill: '#34414d'}));
  for (const layer of PICTURE_LAYERS) {
    const group = pictureLayer(layer, picture, paths);
    const show = isOn => group.setAttribute('visibility', isOn ? 'visible' : 'hidden');
    show(layer.checked);
    svg.append(group);
    const mark = svgElement('svg', {class: 'key_mark', viewBox: '0 0 22 16'},
        svgElement('rect', {width: 22, height: 16, rx: 3, fill: '#34414d'}),
        svgElement('rect', {x: 4, y: 6, width: 14, height: 4, fill: layer.colour}));
    const isEmpty = paths[layer.name] === '';
    if (isEmpty) continue;
    const name = layer.name === 'error' ? `error × ${factor}` : layer.name;
    byId('picture_layers').append(checkBox(name, layer.checked, show, mark));
  }
  if (picture.jpeg) {
    byId('picture').append(element('img', {
      src: `data:image/jpeg;base64,${picture.jpeg}`, alt: `The central frame ${picture.name}`}));
  }
  byId('picture').append(svg);
  byId('picture_caption').textContent =
      `${picture.name}: ${picture.points.length} detected corners (circles) and their projections ` +
      `(crosses); lines are the differences, ${factor} times as long. ` +
      `${counted(picture.rejected.length, 'more corner was', 'more corners were')} rejected, and ` +
      `${counted(picture.not_detected.length, 'marker of the shape faces', 'markers of the shape face')} ` +
      'the camera without having been detected.' +
      (picture.problem ? ` No picture: ${picture.problem}.` : '');
}
