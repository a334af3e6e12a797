'use strict';

// Colours for all kinds of colour vision: Okabe and Ito's palette for parts, viridis for numbers.

const PART_COLOURS = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442',
                      '#6b6b6b'];
const RAMP = ['#440154', '#414487', '#2a788e', '#22a884', '#7ad151', '#fde725'];
const UNKNOWN_COLOUR = '#b8c0c8';
const CHART_COLOUR = '#0b5c8a';
const CHART_ACCENT = '#d55e00';

function rampColour(share) {
  const place = Math.min(1, Math.max(0, share)) * (RAMP.length - 1);
  const index = Math.min(RAMP.length - 2, Math.floor(place));
  return new THREE.Color(RAMP[index]).lerp(new THREE.Color(RAMP[index + 1]), place - index);
}

// Quantities for colouring markers, without those that no marker has.
function colourings(markers) {
  const byNumber = [
    ['area', 'area error', '%', marker => Math.abs(marker.area_deviation_percent)],
    ['error', 'reprojection error', 'px', marker => marker.error_px],
    ['sigma', 'sigma of the centre', 'mm', marker => marker.sigma_mm],
    ['scale', 'scale deviation', '%', marker => Math.abs(marker.scale_deviation_percent)],
  ];
  const made = [partColouring(markers)];
  for (const [key, name, unit, value] of byNumber) {
    const values = markers.map(value).filter(Number.isFinite);
    if (values.length > 0) made.push(numberColouring(key, name, unit, value, values));
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

function numberColouring(key, name, unit, value, values) {
  // The scale ends at a quantile, so that outliers do not compress it.
  const max = roundUp(Math.max(quantile(values, 0.95), 1e-9));
  const colour = marker => {
    const number = value(marker);
    return Number.isFinite(number) ? rampColour(number / max) : new THREE.Color(UNKNOWN_COLOUR);
  };
  const legend = () => [
    element('span', {}, `${name}, ${unit}:`), element('span', {}, '0'),
    element('span', {className: 'ramp', style: `background:linear-gradient(90deg,${RAMP.join()})`}),
    element('span', {}, `${significant(max, 3)} and more`)];
  return {key, name, colour, legend};
}
