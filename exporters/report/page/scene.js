'use strict';

// Objects of the 3D view.

// Sets the vertices of a geometry, x y z in turn, and returns the place where its object belongs. The vertices are
// relative to it, because buffers hold 32-bit floats, which are half a metre apart in the frame of a national grid.
function setVertices(geometry, coordinates) {
  const origin = coordinates.slice(0, 3);
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(
      coordinates.map((value, i) => value - origin[i % 3]), 3));
  return new THREE.Vector3(...origin);
}

const whole = marker => marker.corners.every(corner => corner !== null);

// Two triangles per whole marker, 1 4 3 and 1 3 2 (counter-clockwise from the front), coloured by vertex.
function markerMesh(markers) {
  const positions = markers.flatMap(
      ({corners: [a, b, c, d]}) => [a, d, c, a, c, b].flat());
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('color', new THREE.Float32BufferAttribute(positions.length, 3));
  const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors}));
  mesh.position.copy(setVertices(geometry, positions));
  return mesh;
}

// The backs of the same triangles, in grey.
function markerBacks(mesh) {
  const backs = new THREE.Mesh(mesh.geometry, new THREE.MeshBasicMaterial(
      {color: '#dfe4e8', side: THREE.BackSide}));
  backs.position.copy(mesh.position);
  return backs;
}

function colourMarkers(mesh, markers, colouring) {
  const colours = mesh.geometry.getAttribute('color');
  markers.forEach((marker, i) => {
    const colour = colouring.colour(marker);
    for (let vertex = 6 * i; vertex < 6 * i + 6; ++vertex) {
      colours.setXYZ(vertex, colour.r, colour.g, colour.b);
    }
  });
  colours.needsUpdate = true;
}

function lines(points, colour) {
  const geometry = new THREE.BufferGeometry();
  const segments = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: colour}));
  segments.position.copy(setVertices(geometry, points.flat()));
  return segments;
}

function markerOutlines(markers) {
  return lines(markers.flatMap(({corners: [a, b, c, d]}) => [a, b, b, c, c, d, d, a]), '#25313c');
}

// One pyramid of this depth per image; the central one in orange.
function cameraLines(images, depth) {
  const group = new THREE.Group();
  for (const isCentral of [false, true]) {
    const points = images.filter(image => image.centre && Boolean(image.central) === isCentral)
        .flatMap(({centre, frustum}) => {
          const [a, b, c, d] = frustum.map(ray => ray.map((r, i) => centre[i] + depth * r));
          return [centre, a, centre, b, centre, c, centre, d, a, b, b, c, c, d, d, a];
        });
    if (points.length > 0) group.add(lines(points, isCentral ? CHART_ACCENT : '#7a8794'));
  }
  return group;
}

const ELLIPSOID_COLOUR = '#c2185b';

// 1 sigma ellipsoids of the centres; `group.setFactor` enlarges them, and `group.legend` says by
// how much.
function ellipsoids(markers) {
  const group = new THREE.Group();
  const sphere = new THREE.SphereBufferGeometry(1, 16, 10);
  const material = new THREE.MeshLambertMaterial({color: ELLIPSOID_COLOUR});
  const known = markers.filter(marker => marker.ellipsoid);
  for (const marker of known) {
    const mesh = new THREE.Mesh(sphere, material);
    mesh.matrixAutoUpdate = false;
    group.add(mesh);
  }
  group.setFactor = factor => {
    group.legend = `1 sigma × ${factor}, without the errors that markers share`;
    known.forEach(({centre, ellipsoid}, i) => {
      const axes = ellipsoid.map(axis => new THREE.Vector3(...axis).multiplyScalar(factor));
      group.children[i].matrix.makeBasis(...axes).setPosition(...centre);
    });
  };
  return group;
}

function sectionLines(sections) {
  const points = sections.filter(section => section.profile_in_shape).flatMap(
      ({profile_in_shape: profile}) => profile.slice(1).flatMap((x, i) => [profile[i], x]));
  return lines(points, '#0b2239');
}

function surfaceMesh(surfaces) {
  const group = new THREE.Group();
  for (const surface of surfaces) group.add(oneSurface(surface));
  return group;
}

function oneSurface(surface) {
  const geometry = new THREE.BufferGeometry();
  const origin = setVertices(geometry, surface.vertices);
  geometry.setIndex(surface.triangles);
  geometry.computeVertexNormals();
  const mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({
    color: '#9fc3da', side: THREE.DoubleSide, transparent: true, opacity: 0.75,
    polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2}));
  mesh.position.copy(origin);
  return mesh;
}

const boxOf = points => new THREE.Box3().setFromPoints(points);

const sizeOf = points => boxOf(points).getSize(new THREE.Vector3()).length();

// What the view has to hold: `main`, all markers and the sails to the edges of their cloth. Where the
// sails would fill less than half of it, they are alone, and `outside` names the other parts.
function framing(markers, surfaces) {
  const sails = surfaces.filter(surface => surface.is_sail);
  const isOfSail = marker => sails.some(({part}) => part === marker.part);
  const cornersOf = some => some.flatMap(({corners}) => corners).map(x => new THREE.Vector3(...x));
  const cloth = sails.flatMap(({vertices}) => Array.from(
      {length: vertices.length / 3}, (_, i) => new THREE.Vector3().fromArray(vertices, 3 * i)));
  const all = [...cornersOf(markers), ...cloth];
  const ofSails = [...cornersOf(markers.filter(isOfSail)), ...cloth];
  if (ofSails.length === 0 || 2 * sizeOf(ofSails) >= sizeOf(all)) return {all, main: all, outside: []};
  const others = markers.filter(marker => !isOfSail(marker)).map(({part}) => part || 'no part');
  return {all, main: ofSails, outside: [...new Set(others)].sort()};
}

// Axes of the frame along three edges of the box of the points, with a tick at each round number of
// metres; `labels` are the texts with their places, the names first. y runs along the end of x, away
// from z, where the ticks of one would stand beside those of the other.
function boxAxes(points) {
  const box = boxOf(points);
  const size = box.getSize(new THREE.Vector3());
  const step = roundUp(Math.max(size.x, size.y, size.z) / 5);
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  const ends = [], names = [], ticks = [];
  for (const [axis, other, side] of [['x', 'y', -1], ['z', 'x', -1], ['y', 'x', 1]]) {
    const at = (place, aside) => {
      const x = box.min.clone();
      x[axis] = place;
      x[other] = (side > 0 ? box.max : box.min)[other] + side * aside;
      return x;
    };
    ends.push(at(box.min[axis], 0), at(box.max[axis], 0));
    for (let k = Math.ceil(box.min[axis] / step); k * step <= box.max[axis]; ++k) {
      ends.push(at(k * step, 0), at(k * step, 0.1 * step));
      if (axis !== 'y' && box.max[axis] - k * step < 0.4 * step) continue;  // its name stands there
      ticks.push({text: (k * step).toFixed(digits), place: at(k * step, 0.25 * step)});
    }
    names.push({text: `${axis}, m`, place: axis === 'y' ? at(box.max[axis] + 0.25 * step, 0)
                                                          : at(box.max[axis], 0.3 * step)});
  }
  return {object: lines(ends.map(x => x.toArray()), '#7a8794'), labels: [...names, ...ticks]};
}

// Layers that can be hidden: {key, name, object, isOn}.
function makeLayers(data, markers, size) {
  const layers = [{key: 'markers', name: 'markers', object: new THREE.Group(), isOn: true}];
  layers[0].object.add(markerOutlines(markers));
  if (data.images.length > 0) {
    layers.push({key: 'cameras', name: 'cameras', object: cameraLines(data.images, 0.03 * size), isOn: false});
  }
  if (markers.some(marker => marker.ellipsoid)) {
    layers.push({key: 'ellipsoids', name: 'ellipsoids', object: ellipsoids(markers), isOn: true});
  }
  if (data.sections && data.sections.some(section => section.profile_in_shape)) {
    layers.push({key: 'sections', name: 'sections', object: sectionLines(data.sections), isOn: true});
  }
  if (data.surfaces) {
    layers.push({key: 'surfaces', name: 'surfaces', object: surfaceMesh(data.surfaces), isOn: true});
  }
  return layers;
}
