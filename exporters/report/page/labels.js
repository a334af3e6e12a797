'use strict';

// Labels of markers, in the 3D view and on the central image.

// Places of the labels of this size that cover no label before: at the marker, or the nearest free
// place around it, if there is one.
function freePlaces(markers, size) {
  const boxes = [];
  return markers.map(({id, x, y}) => {
    const width = (0.6 * String(id).length + 0.3) * size;
    const isFree = ([left, top]) => boxes.every(([l, t, w]) =>
        Math.abs(l - left) > (w + width) / 2 || Math.abs(t - top) > 1.1 * size);
    const tried = [[x, y]];
    for (let ring = 1; ring < 6; ++ring) {
      for (let i = 0; i < 8; ++i) {
        const angle = (i + 2) * Math.PI / 4;
        tried.push([x + ring * 1.2 * size * Math.cos(angle), y - ring * 1.2 * size * Math.sin(angle)]);
      }
    }
    const place = tried.find(isFree);
    const [left, top] = place || [x, y];
    boxes.push([left, top, width]);
    return {id, x, y, left, top, isFree: place !== undefined};
  });
}

// Whether the marker's front faces the camera of the view.
function isFacing(marker, view) {
  const [a, b, c] = marker.corners.map(x => new THREE.Vector3(...x));
  const normal = new THREE.Vector3().crossVectors(a.clone().sub(b), c.clone().sub(b));
  return normal.dot(view.camera.position.clone().sub(new THREE.Vector3(...marker.centre))) > 0;
}

// Shows the ids of the markers that face the viewer, with lines to those that are away from their
// markers. An id that finds no place is shown once the view is closer.
function placeIds(view) {
  const {clientWidth: width, clientHeight: height} = view.container;
  const shown = view.markers.flatMap((marker, i) => {
    const label = byId('view_ids').children[i];
    label.hidden = true;
    const x = new THREE.Vector3(...marker.centre).project(view.camera);
    const isInside = Math.max(Math.abs(x.x), Math.abs(x.y)) < 1;
    if (!view.idsAreOn || !isInside || !isFacing(marker, view)) return [];
    return [{id: marker.id, x: (x.x + 1) / 2 * width, y: (1 - x.y) / 2 * height, label}];
  });
  const size = 13;  // of a label with its margins, px
  view.idLines = freePlaces(shown, size).flatMap(({x, y, left, top, isFree}, i) => {
    const {label} = shown[i];
    label.hidden = !isFree;
    label.at = [left, top];
    label.style.transform = `translate(${left}px,${top}px) translate(-50%,-50%)`;
    return left === x && top === y ? [] : [[x, y, left, top]];
  });
  byId('view_id_lines').firstElementChild.setAttribute(
      'd', view.idLines.map(([x, y, left, top]) => `M${x} ${y}L${left} ${top}`).join(''));
}
