'use strict';

// The 3D view. three.js draws it only after a change.

const FACTORS = [1, 2, 5].flatMap(f => [0, 1, 2, 3, 4, 5].map(power => f * 10 ** power))
    .sort((a, b) => a - b);

class View3D {
  // `describe` gives the text of a marker that is pointed at.
  constructor(data, container, describe = markerText) {
    this.container = container;
    this.describe = describe;
    this.markers = data.markers.filter(whole);
    this.images = data.images;
    this.renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.setClearColor('#ffffff');
    container.prepend(this.renderer.domElement);
    this.setFrame(data.frame);
    this.makeScene(data);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableKeys = false;  // they would take the arrow keys from the whole page
    this.controls.screenSpacePanning = true;
    this.controls.addEventListener('change', () => this.render());
    this.resize();
    this.setView(20, 15);
    new ResizeObserver(() => this.resize()).observe(container);
    this.addPointing();
  }

  setFrame({up, forward}) {
    this.up = new THREE.Vector3(...up);
    this.forward = new THREE.Vector3(...forward);
    this.right = new THREE.Vector3().crossVectors(this.forward, this.up);
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
    this.camera.up.copy(this.up);
  }

  makeScene(data) {
    this.corners = this.markers.flatMap(marker => marker.corners).map(x => new THREE.Vector3(...x));
    const box = new THREE.Box3().setFromPoints(this.corners);
    const size = box.getSize(new THREE.Vector3()).length();
    // Cameras can be far away; a 24-bit depth buffer allows this ratio.
    this.camera.near = size / 500;
    this.camera.far = size * 200;
    this.scene = new THREE.Scene();
    this.layers = makeLayers(data, this.markers, size);
    this.mesh = markerMesh(this.markers);
    this.layers[0].object.add(this.mesh, markerBacks(this.mesh));
    for (const layer of this.layers) this.scene.add(layer.object);
    const lamp = new THREE.DirectionalLight('#ffffff', 0.55);
    lamp.position.set(0.3, 0.5, 1);
    this.camera.add(lamp);
    this.scene.add(this.camera, new THREE.AmbientLight('#ffffff', 0.55));
    for (const marker of this.markers) {
      byId('view_ids').append(element('span', {textContent: marker.id, hidden: true}));
    }
  }

  // Azimuth to the right of the front view and elevation above the horizon, degrees. All points fit at
  // a zoom of 1.
  setView(azimuth, elevation, zoom = 1, points = this.corners) {
    const box = new THREE.Box3().setFromPoints(points);
    this.controls.target.copy(box.getCenter(new THREE.Vector3()));
    this.place(azimuth, elevation, 1);
    const tangent = Math.tan(this.camera.fov * Math.PI / 360);
    const turned = this.camera.quaternion.clone().inverse();
    const distances = points.map(point => {
      const x = point.clone().sub(this.controls.target).applyQuaternion(turned);
      return x.z + 1.08 * Math.max(Math.abs(x.y), Math.abs(x.x) / this.camera.aspect) / tangent;
    });
    this.place(azimuth, elevation, Math.max(...distances) / zoom);
  }

  // Places the camera around the target at this distance.
  place(azimuth, elevation, distance) {
    const a = azimuth * Math.PI / 180, e = Math.min(89.9, Math.max(-89.9, elevation)) * Math.PI / 180;
    this.camera.position.copy(this.controls.target)
        .addScaledVector(this.forward, -distance * Math.cos(e) * Math.cos(a))
        .addScaledVector(this.right, distance * Math.cos(e) * Math.sin(a))
        .addScaledVector(this.up, distance * Math.sin(e));
    this.controls.update();
    this.render();
  }

  // Shows the cameras, too.
  showAll() {
    const cameras = this.images.filter(image => image.centre)
        .map(image => new THREE.Vector3(...image.centre));
    this.setView(20, 15, 1, [...this.corners, ...cameras]);
  }

  // Rotates the current view, degrees.
  turn(azimuth, elevation, zoom) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const distance = offset.length();
    const nowAt = Math.atan2(offset.dot(this.right), -offset.dot(this.forward)) * 180 / Math.PI;
    const height = Math.asin(offset.dot(this.up) / distance) * 180 / Math.PI;
    this.place(nowAt + azimuth, height + elevation, distance / zoom);
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.container;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  render() {
    for (const layer of this.layers) layer.object.visible = layer.isOn;
    this.renderer.render(this.scene, this.camera);
    if (this.idsAreOn !== undefined) this.placeIds();
  }

  colourBy(colouring) {
    colourMarkers(this.mesh, this.markers, colouring);
    byId('legend').replaceChildren(...colouring.legend());
    this.render();
  }

  // Shows the ids of the markers that face the viewer.
  placeIds() {
    const {clientWidth: width, clientHeight: height} = this.container;
    this.markers.forEach((marker, i) => {
      const label = byId('view_ids').children[i];
      const [a, b, c] = marker.corners.map(x => new THREE.Vector3(...x));
      const normal = new THREE.Vector3().crossVectors(a.clone().sub(b), c.clone().sub(b));
      const centre = new THREE.Vector3(...marker.centre);
      const isSeen = normal.dot(this.camera.position.clone().sub(centre)) > 0;
      label.hidden = !this.idsAreOn || !isSeen;
      if (label.hidden) return;
      const x = centre.project(this.camera);
      label.style.transform = `translate(${(x.x + 1) / 2 * width}px,${(1 - x.y) / 2 * height}px)` +
          ' translate(-50%,-50%)';
    });
  }

  markerAt(event) {
    const frame = this.renderer.domElement.getBoundingClientRect();
    const place = new THREE.Vector2((event.clientX - frame.left) / frame.width * 2 - 1,
                                    1 - (event.clientY - frame.top) / frame.height * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, this.camera);
    const [hit] = ray.intersectObject(this.mesh);
    return hit && this.markers[Math.floor(hit.faceIndex / 2)];
  }

  // Shows a marker's numbers beside the pointer.
  addPointing() {
    const tip = byId('view_tip');
    const show = event => {
      const marker = this.layers[0].isOn && event.buttons === 0 && this.markerAt(event);
      tip.hidden = !marker;
      if (!marker) return;
      tip.textContent = this.describe(marker);
      const frame = this.container.getBoundingClientRect();
      const x = Math.min(event.clientX - frame.left + 14, frame.width - tip.offsetWidth - 4);
      const y = Math.min(event.clientY - frame.top + 14, frame.height - tip.offsetHeight - 4);
      tip.style.transform = `translate(${Math.max(0, x)}px,${Math.max(0, y)}px)`;
    };
    this.container.addEventListener('pointermove', show);
    this.container.addEventListener('click', show);
    this.container.addEventListener('pointerleave', event => {
      if (event.pointerType === 'mouse') tip.hidden = true;
    });
  }
}

function markerText(marker) {
  const lines = [`Marker ${marker.id}${marker.part ? ` (${marker.part})` : ''}`];
  const add = (name, value, digits, unit) => {
    if (value !== undefined) lines.push(`${name} ${fixed(value, digits)} ${unit}`);
  };
  add('area', marker.area_deviation_percent, 2, '% from the printed one');
  add('reprojection error', marker.error_px, 3, 'px');
  add('scale by itself', marker.scale_deviation_percent, 2, '%');
  add('sigma of the centre', marker.sigma_mm, 3, 'mm');
  lines.push(`seen in ${marker.num_images} images`);
  return lines.join('\n');
}
