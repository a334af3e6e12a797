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
    container.prepend(this.renderer.domElement);
    this.setFrame(data.frame);
    this.makeScene(data);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.letThePageScroll();
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
    this.cameras = {perspective: new THREE.PerspectiveCamera(35, 1, 0.01, 100),
                    parallel: new THREE.OrthographicCamera(-1, 1, 1, -1, 0.01, 100)};
    for (const camera of Object.values(this.cameras)) camera.up.copy(this.up);
    this.camera = this.cameras.perspective;
    this.tangent = Math.tan(this.camera.fov * Math.PI / 360);
  }

  // The wheel and one finger scroll the page unless the view has the focus.
  letThePageScroll() {
    const change = isActive => {
      this.controls.enableZoom = isActive;
      this.renderer.domElement.style.touchAction = isActive ? 'none' : 'pan-y';
    };
    change(false);
    this.container.addEventListener('focus', () => change(true));
    this.container.addEventListener('blur', () => change(false));
    // The controls keep the browser from focusing what is clicked.
    this.renderer.domElement.addEventListener('pointerup', () => this.container.focus({preventScroll: true}));
    this.container.addEventListener('keydown', event => {
      if (event.key === 'Escape') this.container.blur();
    });
  }

  // Parallel rays instead of those through the centre of a camera; the size at the target stays.
  setParallel(isOn) {
    const distance = this.distance();
    const camera = isOn ? this.cameras.parallel : this.cameras.perspective;
    camera.position.copy(this.camera.position);
    this.camera = this.controls.object = camera;
    this.scene.add(camera);
    camera.add(this.lamp);
    const offset = camera.position.clone().sub(this.controls.target).setLength(distance);
    camera.position.copy(this.controls.target).add(offset);
    this.fitFrustum(distance);
    this.controls.update();
    this.render();
  }

  // The distance at which the perspective camera shows the target as large as it is now.
  distance() {
    return this.camera.position.distanceTo(this.controls.target) / this.camera.zoom;
  }

  fitFrustum(distance) {
    const half = distance * this.tangent, aspect = this.aspect || 1;
    Object.assign(this.cameras.parallel,
        {top: half, bottom: -half, left: -half * aspect, right: half * aspect, zoom: 1});
    this.cameras.perspective.aspect = aspect;
    for (const camera of Object.values(this.cameras)) camera.updateProjectionMatrix();
  }

  makeScene(data) {
    Object.assign(this, framing(this.markers, data.surfaces || []));
    const size = sizeOf(this.all);
    // Cameras can be far away; a 24-bit depth buffer allows this ratio.
    for (const camera of Object.values(this.cameras)) Object.assign(camera, {near: size / 500, far: size * 200});
    this.scene = new THREE.Scene();
    this.layers = makeLayers(data, this.markers, size);
    this.mesh = markerMesh(this.markers);
    this.layers[0].object.add(this.mesh, markerBacks(this.mesh));
    const axes = boxAxes(this.main);
    this.main.push(...axes.labels.map(({place}) => place));  // so that none is cut off
    this.axes = {key: 'axes', name: 'axes', object: axes.object, isOn: true, labels: axes.labels};
    this.layers.push(this.axes);
    byId('view_axes').append(...axes.labels.map(({text}) => element('span', {textContent: text})));
    for (const layer of this.layers) this.scene.add(layer.object);
    this.lamp = new THREE.DirectionalLight('#ffffff', 0.55);
    this.lamp.position.set(0.3, 0.5, 1);
    this.camera.add(this.lamp);
    this.scene.add(this.camera, new THREE.AmbientLight('#ffffff', 0.55));
    for (const marker of this.markers) {
      byId('view_ids').append(element('span', {textContent: marker.id, hidden: true}));
    }
  }

  // Azimuth to the right of the front view and elevation above the horizon, degrees. All points fit at
  // a zoom of 1.
  setView(azimuth, elevation, zoom = 1, points = this.main) {
    this.controls.target.copy(boxOf(points).getCenter(new THREE.Vector3()));
    this.place(azimuth, elevation, 1);
    const turned = this.camera.quaternion.clone().inverse();
    const distances = points.map(point => {
      const x = point.clone().sub(this.controls.target).applyQuaternion(turned);
      return x.z + 1.08 * Math.max(Math.abs(x.y), Math.abs(x.x) / this.aspect) / this.tangent;
    });
    this.place(azimuth, elevation, distances.reduce((a, b) => Math.max(a, b)) / zoom);
  }

  // Places the camera around the target at this distance.
  place(azimuth, elevation, distance) {
    const a = azimuth * Math.PI / 180, e = Math.min(89.9, Math.max(-89.9, elevation)) * Math.PI / 180;
    this.camera.position.copy(this.controls.target)
        .addScaledVector(this.forward, -distance * Math.cos(e) * Math.cos(a))
        .addScaledVector(this.right, distance * Math.cos(e) * Math.sin(a))
        .addScaledVector(this.up, distance * Math.sin(e));
    this.fitFrustum(distance);
    this.controls.update();
    this.render();
  }

  // Shows the cameras as well.
  showAll() {
    const cameras = this.images.filter(image => image.centre)
        .map(image => new THREE.Vector3(...image.centre));
    const layer = this.layers.find(({key}) => key === 'cameras');
    if (layer) layer.isOn = layer.box.checked = true;
    this.setView(20, 15, 1, [...this.all, ...cameras]);
  }

  // Rotates the current view, degrees.
  turn(azimuth, elevation, zoom) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const distance = this.distance();
    const nowAt = Math.atan2(offset.dot(this.right), -offset.dot(this.forward)) * 180 / Math.PI;
    const height = Math.asin(offset.dot(this.up) / offset.length()) * 180 / Math.PI;
    this.place(nowAt + azimuth, height + elevation, distance / zoom);
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.container;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    const distance = this.distance();
    this.aspect = width / height;
    this.fitFrustum(distance);
    this.render();
  }

  render() {
    for (const layer of this.layers) layer.object.visible = layer.isOn;
    this.renderer.setClearColor(pageColour('--paper'));
    this.renderer.render(this.scene, this.camera);
    this.placeAxes();
    this.placeBar();
    if (this.idsAreOn !== undefined) placeIds(this);
  }

  // A label that the left or right border would cut is moved inside.
  placeLabel(label, place) {
    const {clientWidth: width, clientHeight: height} = this.container;
    const x = place.clone().project(this.camera);
    const half = 3.5 * label.textContent.length + 2, middle = (x.x + 1) / 2 * width;
    const inside = Math.max(half, Math.min(middle, width - half));
    const isCut = Math.abs(inside - middle) < 2 * half;
    label.at = [isCut ? inside : middle, (1 - x.y) / 2 * height];
    label.style.transform = `translate(${label.at[0]}px,${label.at[1]}px) translate(-50%,-50%)`;
  }

  // The view with its labels and its scale bar on one canvas.
  picture() {
    this.resize();  // and draws: a WebGL canvas keeps its content only until the browser shows it
    const drawn = this.renderer.domElement;
    const canvas = element('canvas', {width: drawn.width, height: drawn.height});
    const context = canvas.getContext('2d');
    context.drawImage(drawn, 0, 0);
    const ratio = drawn.width / this.container.clientWidth;
    context.scale(ratio, ratio);
    Object.assign(context, {font: '12px sans-serif', textAlign: 'center', textBaseline: 'middle',
                            fillStyle: pageColour('--ink'), strokeStyle: pageColour('--ink')});
    for (const [x, y, left, top] of this.idLines || []) {
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(left, top);
      context.stroke();
    }
    for (const label of this.container.querySelectorAll('#view_ids span, #view_axes span')) {
      if (!label.hidden && label.at) context.fillText(label.textContent, ...label.at);
    }
    const bar = byId('view_bar');
    context.fillRect(bar.offsetLeft, bar.offsetTop + bar.offsetHeight, bar.offsetWidth, 3);
    context.fillText(bar.textContent, bar.offsetLeft + bar.offsetWidth / 2, bar.offsetTop + 4);
    return canvas;
  }

  // A label that would touch one before it is left out: where an axis points at the viewer, its ticks
  // stand in one place.
  placeAxes() {
    const shown = [];
    this.axes.labels.forEach(({place}, i) => {
      const label = byId('view_axes').children[i];
      label.hidden = !this.axes.isOn;
      if (label.hidden) return;
      this.placeLabel(label, place);
      const touches = other => Math.abs(other.at[1] - label.at[1]) < 12 && Math.abs(other.at[0] - label.at[0]) <
          3.5 * (other.textContent.length + label.textContent.length) + 4;
      label.hidden = shown.some(touches);
      if (!label.hidden) shown.push(label);
    });
  }

  // A round length at the middle of the view.
  placeBar() {
    const metresPerPixel = 2 * this.distance() * this.tangent / this.container.clientHeight;
    const longest = 0.3 * Math.min(this.container.clientWidth, 500) * metresPerPixel;
    if (!(longest > 0)) return;
    const power = 10 ** Math.floor(Math.log10(longest));
    const length = power * [5, 2, 1].find(factor => factor * power <= longest);
    const bar = byId('view_bar');
    bar.style.width = `${length / metresPerPixel}px`;
    bar.firstElementChild.textContent = length >= 1 ? `${significant(length, 2)} m`
                                                    : `${significant(1e3 * length, 2)} mm`;
  }

  colourBy(colouring) {
    this.colouring = colouring;
    colourMarkers(this.mesh, this.markers, colouring);
    this.showLegend();
    this.render();
  }

  // The colours of the markers, the ellipsoids, and what the first view leaves out.
  showLegend() {
    const items = this.colouring.legend();
    const ellipsoids = this.layers.find(({key}) => key === 'ellipsoids');
    if (ellipsoids && ellipsoids.isOn && ellipsoids.object.legend) {
      items.push(element('span', {}, element('span', {className: 'swatch', style: `background:${ELLIPSOID_COLOUR}`}),
                         ellipsoids.object.legend));
    }
    if (this.outside.length > 0) {
      items.push(element('span', {className: 'quiet'},
                         `not in the first view: ${this.outside.join(', ')} ("All cameras" shows all)`));
    }
    byId('legend').replaceChildren(...items);
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
