'use strict';

// The page of a comparison: reads the data and fills it.

const BLUE = '#2166ac', WHITE = '#f7f7f7', RED = '#b2182b';  // as in the PLY files

function divergingColour(distance, limit) {
  if (typeof distance !== 'number') return new THREE.Color(UNKNOWN_COLOUR);
  const part = limit > 0 ? Math.min(1, Math.abs(distance) / limit) : 0;
  return new THREE.Color(WHITE).lerp(new THREE.Color(distance < 0 ? BLUE : RED), part);
}

function signed(value, digits) {
  const text = fixed(value, digits);
  return value > 0 && Number(text) !== 0 ? `+${text}` : text;
}

// The colours of the distances of one shape; `key` is its place in the series.
function distanceColouring(data, i) {
  const limit = data.color_limit_mm, end = significant(limit, 3);
  const isPartial = data.markers.some(({distances}) => distances[i] === null || distances[i].is_beside);
  const legend = () => [
    element('span', {}, 'distance, mm:'), element('span', {}, limit > 0 ? `−${end}` : ''),
    element('span', {className: 'ramp', style: `background:linear-gradient(90deg,${BLUE},${WHITE},${RED})`}),
    element('span', {}, limit > 0 ? `+${end}${data.positive_side && ` (${data.positive_side})`}` : '0 everywhere'),
    ...(isPartial ? [element('span', {}, element('span', {className: 'swatch unknown'}), 'unknown')] : []),
  ];
  return {
    key: String(i), name: data.shapes[i].name, legend,
    colour: marker => divergingColour(marker.distances[i]?.distance_mm, limit),
  };
}

// With its border, because most of a surface can be as white as the ground.
function colouredSurface({vertices, triangles, distances_mm: distances}, limit) {
  const geometry = new THREE.BufferGeometry();
  const colours = distances.flatMap(distance => divergingColour(distance, limit).toArray());
  const origin = setVertices(geometry, vertices);
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(colours, 3));
  geometry.setIndex(triangles);
  geometry.computeVertexNormals();
  const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({
    vertexColors: THREE.VertexColors, side: THREE.DoubleSide,
    polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2}));
  const atLeast_deg = 80;
  mesh.add(new THREE.LineSegments(new THREE.EdgesGeometry(geometry, atLeast_deg),
                                  new THREE.LineBasicMaterial({color: '#25313c'})));
  mesh.position.copy(origin);
  return mesh;
}

// One layer with the surfaces of all shapes, of which the chosen one is shown.
function addSurfaces(view, data) {
  if (data.surfaces.every(surface => surface === null)) return;
  const object = new THREE.Group();
  data.surfaces.forEach(surface => object.add(
      surface === null ? new THREE.Group() : colouredSurface(surface, data.color_limit_mm)));
  const choose = () => {
    object.children.forEach((mesh, i) => { mesh.visible = byId('colour').value === String(i); });
    view.render();
  };
  view.layers.push({key: 'surface', name: 'surface', object, isOn: true});
  view.scene.add(object);
  byId('colour').addEventListener('change', choose);
  choose();
}

function describeDistances(data) {
  return marker => [
    `Marker ${marker.id}${marker.part ? ` (${marker.part})` : ''}`,
    ...marker.distances.map((distance, i) => `${data.shapes[i].name}: ${distanceText(distance)} mm`),
  ].join('\n');
}

function distanceText(distance) {
  if (distance === null) return '–';
  if (distance.is_beside) return `beside by ${fixed(distance.beside_mm, 0)}`;
  return uncertain(distance.distance_mm, distance.sigma_mm, 2, signed) +
      (Math.abs(distance.significance) > 2 ? ' *' : '');
}

function fillDistanceView(data) {
  byId('frame').textContent = `Drawn on the reference. Frame: ${data.frame.name}.`;
  if (!hasWebGL()) {
    byId('view').prepend(element('p', {
      className: 'message', textContent: 'This browser offers no WebGL, which the 3D view needs.'}));
    return;
  }
  const view = new View3D({...data, images: [], surfaces: undefined}, byId('view'), describeDistances(data));
  connectColours(view, data.shapes.map((shape, i) => distanceColouring(data, i)));
  addSurfaces(view, data);
  connectLayers(view);
  connectView(view);
  if (!location.hash) view.setView(0, 0);
}

function fillComparisonVerdict({text, items, level}) {
  if (level) {
    byId('verdict').className = `card ${level}`;
    byId('verdict').append(element('p', {className: 'value verdict', textContent: VERDICTS[level]}));
  }
  byId('verdict').append(element('p', {className: 'value', textContent: keepUnits(text)}));
  if (items.length === 0) return;
  byId('verdict').append(element('ul', {}, ...items.map(item =>
      element('li', {textContent: keepUnits(item)}))));
}

// A row for each figure and a column for each shape.
function fillShapes(data) {
  const figures = [
    ['Aligned by', shape => shape.alignment_by], ['Left of the alignment, RMS, mm', shape => shape.residual_mm, 2],
    ['Turned by, °', shape => shape.turn_deg, 2], ['Size against the reference, %', shape => shape.scale_percent, 3],
    ['Markers compared', shape => shape.num_markers, 0], ['of them beyond the edge', shape => shape.num_beyond_edge, 0],
    ['and beside the design', shape => shape.num_beside, 0], ['Distance, mean, mm', shape => shape.mean_mm, 2],
    ['Distance, RMS, mm', shape => shape.rms_mm, 2], ['Distance, largest, mm', shape => shape.largest_mm, 2],
    ['Markers with a sigma', shape => shape.num_with_sigma, 0],
    ['of them significantly off', shape => shape.num_significant, 0],
  ].filter(([, value]) => data.shapes.some(shape => value(shape) !== undefined));
  fillTable('table_shapes', [
    {name: '', value: row => row[0], isText: true},
    ...data.shapes.map(shape => ({
      name: shape.name, value: row => row[1](shape),
      text: ([, value, digits]) => digits === undefined ? value(shape) : fixed(value(shape), digits),
    })),
  ], figures);
  const side = data.is_design ? 'the side to which the faces of the design look'
                              : 'the side to which the markers of the reference face';
  byId('sides').textContent = `Distances are along the normal of ${data.reference}; positive ones are on ${side}${
    data.positive_side && `, which is ${data.positive_side}`}. The sizes are compared, never fitted.`;
}

function differenceText(value) {
  return value === null ? '–' :
    uncertain(value.difference, value.sigma, 2, signed) + (value.is_significant ? ' *' : '');
}

// The reference has its numbers at the markers of each shape.
function referenceText([least, greatest]) {
  const texts = [fixed(least, 2), fixed(greatest, 2)];
  return texts[0] === texts[1] ? texts[0] : texts.join(' to ');
}

function fillNumbers(data) {
  if (data.numbers.length === 0) return;
  byId('sections').hidden = false;
  fillTable('table_sections', [
    text('Section', 'section'),
    {name: 'Number', value: row => `${row.number}, ${row.unit}`, isText: true},
    {name: data.reference, value: row => row.reference_range[0],
     text: row => referenceText(row.reference_range)},
    ...data.shapes.flatMap((shape, i) => [
      {name: shape.name, value: row => row.values[i]?.value, text: row => fixed(row.values[i]?.value, 2)},
      {name: data.shapes.length > 1 ? `${shape.name} minus ${data.reference}` : 'Difference',
       value: row => row.values[i]?.difference, text: row => differenceText(row.values[i])},
    ]),
  ], data.numbers);
}

function fillMarkers(data) {
  fillTable('table_markers', [
    {name: 'Marker', value: row => row.id}, text('Part', 'part'),
    ...data.shapes.map((shape, i) => ({
      name: `${shape.name}, mm`, value: row => row.distances[i]?.distance_mm,
      text: row => distanceText(row.distances[i]),
    })),
  ], data.markers);
}

function main() {
  const data = JSON.parse(byId('data').textContent);
  byId('origin').textContent = [`velamap ${data.version}`, data.created && `computed ${data.created}`].filter(Boolean).join(', ');
  fillComparisonVerdict(data.verdict);
  fillShapes(data);
  fillDistanceView(data);
  fillProfiles(data.profiles, [data.reference, ...data.shapes.map(shape => shape.name)]);
  fillNumbers(data);
  fillMarkers(data);
  document.documentElement.dataset.readyMs = Math.round(performance.now());
}

main();
