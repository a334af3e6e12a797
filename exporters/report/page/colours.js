'use strict';

// Colours for all kinds of colour vision: Okabe and Ito's palette for parts, viridis for numbers, and
// from blue over white to red for numbers with a sign. Those of the page are CSS variables, because a
// dark page has different ones.

const PART_COLOURS = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442',
                      '#6b6b6b'];
const RAMP = ['#440154', '#414487', '#2a788e', '#22a884', '#7ad151', '#fde725'];
const SIGNED_RAMP = ['#2166ac', '#92c5de', '#f7f7f7', '#f4a582', '#b2182b'];
const UNKNOWN_COLOUR = '#b8c0c8';
const CHART_ACCENT = '#d55e00';

// The value of a CSS variable, such as --ink.
function pageColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function rampColour(ramp, share) {
  const place = Math.min(1, Math.max(0, share)) * (ramp.length - 1);
  const index = Math.min(ramp.length - 2, Math.floor(place));
  return new THREE.Color(ramp[index]).lerp(new THREE.Color(ramp[index + 1]), place - index);
}

// Quantities for colouring markers, without those that no marker has.
function colourings(markers) {
  const byNumber = [
    ['area', 'area less the printed one', '%', marker => marker.area_deviation_percent, true],
    ['error', 'reprojection error', 'px', marker => marker.error_px, false],
    ['sigma', 'sigma of the centre', 'mm', marker => marker.sigma_mm, false],
    ['scale', 'scale by the marker alone', '%', marker => marker.scale_deviation_percent, true],
  ];
  const made = [partColouring(markers)];
  for (const [key, name, unit, value, isSigned] of byNumber) {
    const values = markers.map(value).filter(Number.isFinite);
    if (values.length > 0) made.push(numberColouring(key, name, unit, value, values, isSigned));
  }
  return made;
}

function partColouring(markers) {
  const parts = [...new Set(markers.map(marker => marker.part))].sort();
  const colourOf = new Map(parts.map((part, i) => [part, PART_COLOURS[i % PART_COLOURS.length]]));
  const legend = () => parts.map(part => element('span', {},
      element('span', {className: 'swatch', style: `background:${colourOf.get(part)}`}),
      part || 'no part'));
  return {key: 'part', name: 'part', colour: m => new THREE.Color(colourOf.get(m.part)), legend};
}

function numberColouring(key, name, unit, value, values, isSigned) {
  // The scale ends at a quantile, so that outliers do not compress it.
  const max = roundUp(Math.max(quantile(values.map(Math.abs), 0.95), 1e-9));
  const min = isSigned ? -max : 0;
  const ramp = isSigned ? SIGNED_RAMP : RAMP;
  const colour = marker => {
    const number = value(marker);
    return Number.isFinite(number) ? rampColour(ramp, (number - min) / (max - min))
                                   : new THREE.Color(UNKNOWN_COLOUR);
  };
  const legend = () => [
    element('span', {}, `${name}, ${unit}:`),
    element('span', {}, isSigned ? `${significant(min, 3)} and less` : '0'),
    element('span', {className: 'ramp', style: `background:linear-gradient(90deg,${ramp.join()})`}),
    element('span', {}, `${significant(max, 3)} and more`)];
  return {key, name, colour, legend};
}
