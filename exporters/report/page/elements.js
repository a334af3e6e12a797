'use strict';

// Small helpers of the whole page.

function byId(id) {
  return document.getElementById(id);
}

// An element with properties and children (elements or text).
function element(name, properties, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

const SVG = 'http://www.w3.org/2000/svg';

function svgElement(name, attributes, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

// A number with `digits` after the point, or a dash if it is unknown.
function fixed(value, digits) {
  return typeof value === 'number' ? value.toFixed(digits).replace(/^-(?=0\.?0*$)/, '') : '–';
}

// `value ± sigma`, or only the value if it has no sigma. Both have more decimals than `digits` where
// the sigma would be rounded to zero and four decimals are enough to show it.
function uncertain(value, sigma, digits, write = fixed) {
  const maxDigits = 4;
  if (typeof sigma !== 'number') return write(value, digits);
  const needed = sigma > 0 ? Math.ceil(Math.log10(0.5 / sigma)) : 0;
  const shown = needed > maxDigits ? digits : Math.max(digits, needed);
  return `${write(value, shown)} ± ${fixed(sigma, shown)}`;
}

// A number with `digits` significant digits, not in exponential form.
function significant(value, digits) {
  return typeof value === 'number' ? String(Number(value.toPrecision(digits))) : '–';
}

// A check box that tells `change` its state.
function checkBox(text, checked, change, ...marks) {
  const box = element('input', {type: 'checkbox', checked});
  box.addEventListener('change', () => change(box.checked));
  return element('label', {}, box, ...marks, text);
}

// The quantile of the numbers at `share`.
function quantile(values, share) {
  const sorted = values.slice().sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

// The smallest of 1, 2 or 5 times a power of ten that is at least `value`.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find(factor => factor * power >= value * (1 - 1e-9));
}

// The content of a canvas as a PNG, on the colour of the page: its text is light on a dark page.
function pictureOf(canvas) {
  const copy = element('canvas', {width: canvas.width, height: canvas.height});
  const context = copy.getContext('2d');
  context.fillStyle = pageColour('--paper');
  context.fillRect(0, 0, copy.width, copy.height);
  context.drawImage(canvas, 0, 0);
  return copy.toDataURL('image/png');
}

// Saves it under the page's title and `name`.
function savePicture(canvas, name) {
  const file = `${document.title.replace(/ – .*/, '')} ${name}.png`.replace(/[^\w.-]+/g, '_');
  element('a', {href: pictureOf(canvas), download: file}).click();
}

function saveSvg(svg, name) {
  const file = `${document.title.replace(/ – .*/, '')} ${name}.svg`.replace(/[^\w.-]+/g, '_');
  const text = new XMLSerializer().serializeToString(svg);
  element('a', {href: `data:image/svg+xml,${encodeURIComponent(text)}`, download: file}).click();
}

// Calls `draw` when the page becomes dark or light, which it is while it is printed.
function onTheme(draw) {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
  window.addEventListener('beforeprint', () => {
    document.documentElement.classList.add('printing');
    draw();
  });
  window.addEventListener('afterprint', () => {
    document.documentElement.classList.remove('printing');
    draw();
  });
}
