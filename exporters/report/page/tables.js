'use strict';

// Tables that are sorted by a click on a heading. A column is {name, value, text?}: `value` for
// sorting, `text` for display.

function fillTable(id, columns, rows) {
  const body = element('tbody', {});
  const show = sorted => body.replaceChildren(...sorted.map(row => element('tr', {},
      ...columns.map(column => element('td', {
        className: column.isText ? 'text' : '',
        textContent: column.text ? column.text(row) : String(column.value(row) ?? '–'),
      })))));
  show(rows);
  const heads = columns.map((column, index) => sortingHead(column, () => {
    const direction = heads[index].getAttribute('aria-sort') === 'ascending' ? -1 : 1;
    heads.forEach(head => head.removeAttribute('aria-sort'));
    heads[index].setAttribute('aria-sort', direction > 0 ? 'ascending' : 'descending');
    show(rows.slice().sort((a, b) => compare(column.value(a), column.value(b), direction)));
  }));
  byId(id).replaceChildren(element('table', {},
      element('thead', {}, element('tr', {}, ...heads)), body));
}

function sortingHead(column, sort) {
  // Browsers omit a button when a printed table repeats its head.
  const head = element('th', {scope: 'col', className: column.isText ? 'text' : '', tabIndex: 0,
                              title: 'sort', textContent: column.name});
  head.addEventListener('click', sort);
  head.addEventListener('keydown', event => {
    if (event.key === 'Enter') sort();
  });
  return head;
}

// `direction` is 1 to ascend, -1 to descend. Unknown values come last in both.
function compare(a, b, direction) {
  if (a === undefined || b === undefined) return (a === undefined) - (b === undefined);
  return direction * (typeof a === 'string' ? a.localeCompare(b, 'en', {numeric: true}) : a - b);
}

function number(name, key, digits) {
  return {name, value: row => row[key], text: row => fixed(row[key], digits)};
}

// For figures of any size: `digits` are significant ones.
function rounded(name, key, digits, factor = 1) {
  const value = row => row[key] && factor * row[key];
  return {name, value, text: row => significant(value(row), digits)};
}

function text(name, key) {
  return {name, value: row => row[key], isText: true};
}

// No line break between a number and its unit.
function keepUnits(value) {
  return value.replace(/(\d) (?=%|px|mm|m$)/g, '$1\u00a0');
}

const VERDICTS = {good: 'Good', check: 'Check before use', bad: 'Do not use as it is'};

function fillVerdict(verdict) {
  const box = byId('verdict');
  box.className = `card ${verdict.level}`;
  box.append(element('p', {className: 'value verdict', textContent: VERDICTS[verdict.level]}));
  if (verdict.reasons.length === 0) return;
  box.append(element('ul', {}, ...verdict.reasons.map(reason =>
      element('li', {className: reason.level, textContent: keepUnits(reason.text)}))));
}

function fillKeyNumbers(numbers) {
  byId('key_numbers').replaceChildren(...numbers.map(item => {
    const head = element('h3', {}, item.name);
    if (item.status) head.append(element('span', {className: 'verdict', textContent: item.status}));
    return element('article', {className: `card ${item.status}`}, head,
        element('p', {className: 'value', textContent: keepUnits(item.value)}),
        element('p', {className: 'meaning', textContent: item.meaning}));
  }));
}

function fillReasons(place, key, name, rows) {
  if (rows.length === 0) {
    byId(place).append(element('p', {textContent: `${name}: none.`}));
    return;
  }
  const id = `table_${key}`;
  byId(place).append(element('details', {open: rows.length <= 8},
      element('summary', {textContent: `${name}: ${rows.length}`}), element('div', {id, className: 'table'})));
  fillTable(id, [text(name.slice(0, -1), 'name'), text('Reason', 'reason')], rows);
}

function fillLeftOut(data) {
  for (const [key, name] of [['images_left_out', 'Images'], ['markers_left_out', 'Markers']]) {
    fillReasons('left_out', key, name, data[key]);
  }
  if (data.images_not_needed.length === 0) return;
  byId('not_needed').hidden = false;
  fillReasons('not_needed', 'images_not_needed', 'Images', data.images_not_needed);
}

function fillTables(data) {
  fillTable('table_markers', [
    {name: 'Marker', value: row => row.id}, text('Part', 'part'), {name: 'Images', value: row => row.num_images},
    number('Area, %', 'area_deviation_percent', 2), number('Side, %', 'side_deviation_percent', 2),
    number('Reprojection, px', 'error_px', 3), number('Scale, %', 'scale_deviation_percent', 2),
    number('Sigma, mm', 'sigma_mm', 3),
  ].filter(column => data.markers.some(row => column.value(row) !== undefined)), data.markers);
  fillTable('table_images', [
    text('Image', 'name'), {name: 'Markers', value: row => row.num_markers},
    {name: 'Ratio, %', value: row => row.marker_ratio, text: row => fixed(row.marker_ratio * 100, 1)},
    number('Mean error, px', 'error_mean_px', 3), number('RMS, px', 'error_rms_px', 3),
    number('Largest, px', 'error_max_px', 2),
  ].filter(column => data.images.some(row => column.value(row) !== undefined)), data.images);
  fillTable('table_options', [
    {name: 'Option', value: row => row[0], isText: true},
    {name: 'Value', value: row => row[1], isText: true},
  ], [['velamap', data.version], ...data.versions, ...data.options]);
  fillKnownPoints(data.known_points);
  if (!data.scale_audit) return;
  byId('audit').hidden = false;
  fillTable('table_audit', [
    {name: 'Figure', value: row => inWords(row[0]), isText: true},
    {name: 'Value', value: row => auditValue(row[1]), isText: true},
  ], data.scale_audit);
}

// A key in words, with its unit: `side_px` is `side, px`.
function inWords(key) {
  const units = {percent: '%', px: 'px', mm: 'mm', um: 'µm', deg: '°'};
  const words = key.split('_');
  const unit = units[words[words.length - 1]];
  if (unit) words.pop();
  const text = words.join(' ').replace(/^num /, 'number of ')
      .replace('x over y', 'width over height less 1');
  return (text[0].toUpperCase() + text.slice(1)) + (unit ? `, ${unit}` : '');
}

// A fraction with three digits, or one decimal if it is large; a list of ids; the row of a table, a
// list of [key, value], as `name value unit`.
function auditValue(value) {
  if (typeof value === 'number') {
    if (Number.isInteger(value)) return String(value);
    return Math.abs(value) < 100 ? significant(value, 3) : fixed(value, 1);
  }
  if (!Array.isArray(value)) return value || 'none';
  if (!Array.isArray(value[0])) return value.join(' ') || 'none';
  return value.map(([key, figure]) => {
    const [name, unit] = inWords(key).split(', ');
    return `${name.toLowerCase()} ${auditValue(figure)}${unit ? ` ${unit}` : ''}`;
  }).join('; ');
}

function fillRigs(rigs) {
  if (!rigs) return;
  byId('table_rigs').hidden = byId('note_rigs').hidden = false;
  fillTable('table_rigs', [
    text('Rig', 'part'),
    figure('Luff bend forwards, mm', 'luff_bend', 'mm', 1, 1),
    figure('Luff sag to leeward, mm', 'luff_sag', 'mm', 1, 1),
    figure('Sheeting angle, °', 'sheeting_angle', 'deg', 2, 1),
  ].filter(column => rigs.some(row => column.value(row) !== undefined)), rigs);
}

function fillNotes(id, notes) {
  byId(id).append(...(notes || []).map(textContent => element('p', {textContent})));
}

function fillSurfaces({surfaces, surface_notes: notes}) {
  if (!surfaces && !notes) return;
  byId('surfaces').hidden = false;
  fillNotes('note_surfaces', notes);
  if (!surfaces) return;
  const isSmall = surfaces.every(row => row.area_m2 < 0.1);
  const [unit, unitPerM] = isSmall ? ['mm', 1000] : ['m', 1];
  fillTable('table_surfaces', [
    {name: 'Part', value: row => row.part || 'all markers', isText: true},
    rounded(`Area, ${unit}²`, 'area_m2', 4, unitPerM ** 2),
    rounded(`Volume, ${unit}³`, 'volume_m3', 4, unitPerM ** 3),
    rounded('From the markers (RMS), mm', 'distance_mm', 2), rounded('Sigma, mm', 'sigma_mm', 2),
  ].filter(column => surfaces.some(row => column.value(row) !== undefined)), surfaces);
}

function fillKnownPoints(points) {
  if (!points) return;
  byId('known_points').hidden = false;
  fillTable('table_known_points', [
    text('Point', 'point'), text('Use', 'use'), number('dx, mm', 'dx_mm', 2), number('dy, mm', 'dy_mm', 2),
    number('dz, mm', 'dz_mm', 2), number('Distance, mm', 'distance_mm', 2), number('Sigmas', 'in_sigmas', 1),
    text('Result', 'result'),
  ], points);
}

// A figure with its standard deviation, if known: their keys are START_UNIT and START_sigma_UNIT.
function figure(name, start, unit, digits, factor) {
  const key = `${start}_${unit}`, sigmaKey = `${start}_sigma_${unit}`;
  return {
    name, value: row => row[key],
    text: row => row[key] === undefined ? '–' :
      uncertain(row[key] * factor, row[sigmaKey] && row[sigmaKey] * factor, digits),
  };
}

function fillSections({sections, section_notes: notes, design}) {
  byId('sections').hidden = false;
  fillNotes('note_sections', notes);
  if (design) {
    byId('note_design').hidden = false;
    byId('note_design').textContent = `Dashed: ${design.name}, placed so that the markers fit it best. ${
        design.num_markers} markers lie ${significant(design.distance_mm, 3)} mm RMS from it.`;
  }
  fillTable('table_sections', [
    text('Section', 'name'), number('Height, m', 'height_m', 3),
    figure('Chord, mm', 'chord', 'm', 1, 1000),
    figure('Camber, %', 'camber', 'percent', 2, 1),
    figure('Draft, %', 'draft', 'percent', 1, 1),
    figure('Entry, °', 'entry_angle', 'deg', 1, 1),
    figure('Exit, °', 'exit_angle', 'deg', 1, 1),
    figure('Twist, °', 'twist', 'deg', 2, 1),
    figure('Leech twist, °', 'leech_twist', 'deg', 1, 1),
    figure('Girth, mm', 'girth', 'm', 1, 1000),
    text('Incomplete', 'note'),
  ].filter(column => sections.some(row => column.value(row) !== undefined)), sections);
}
