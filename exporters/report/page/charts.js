'use strict';

// The charts, drawn by Chart.js.

const charts = [];

function setChartDefaults() {
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.color = pageColour('--quiet');
  Chart.defaults.borderColor = pageColour('--line');
  Chart.defaults.plugins.legend.display = false;
}

// Draws all charts, or redraws them in the current colours and for the current width of the page.
function drawCharts(data) {
  for (const chart of charts.splice(0)) {
    chart.observer?.disconnect();
    chart.canvas.parentElement.querySelectorAll('.save').forEach(button => button.remove());
    chart.destroy();
  }
  setChartDefaults();
  if (data.sections) sectionChart(data.sections);
  fillCharts(data);
}

function axis(title, more) {
  return Object.assign({title: {display: true, text: title}}, more);
}

function addChart(id, title, config) {
  config.options.plugins = Object.assign(
      {title: {display: true, text: title, align: 'start', font: {size: 14, weight: '600'}}},
      config.options.plugins);
  byId(id).setAttribute('role', 'img');
  byId(id).setAttribute('aria-label', title);
  const chart = new Chart(byId(id), config);
  charts.push(chart);
  addSaving(chart, 'PNG', `save the chart "${title}" as a picture`, () => savePicture(chart.canvas, title));
  return chart;
}

function addSaving(chart, textContent, title, save) {
  const buttons = chart.canvas.parentElement.querySelectorAll('.save').length;
  const button = element('button', {type: 'button', className: 'save screen_only', textContent, title,
                                    style: `right:${44 * buttons}px`});
  button.addEventListener('click', save);
  chart.canvas.parentElement.append(button);
}

function histogramChart(id, captionId, title, unit, histogram, meaning) {
  const border = i => histogram.first_border + i * histogram.bin_width;
  const digits = Math.max(0, -Math.floor(Math.log10(histogram.bin_width || 1)));
  const range = i => `${fixed(border(i), digits)} to ${fixed(border(i + 1), digits)} ${unit}`;
  addChart(id, title, {
    type: 'bar',
    data: {
      datasets: [{
        data: histogram.counts.map((count, i) => ({x: border(i + 0.5), y: count})),
        backgroundColor: pageColour('--accent'), barPercentage: 1, categoryPercentage: 0.96,
      }],
    },
    options: {
      scales: {
        x: axis(unit, {
          type: 'linear', min: border(0), max: border(histogram.counts.length), offset: false,
          grid: {offset: false},
        }),
        y: axis('count', {beginAtZero: true, ticks: {precision: 0}}),
      },
      plugins: {tooltip: {callbacks: {title: items => range(items[0].dataIndex)}}},
    },
  });
  const strays = [[histogram.num_below, 'below'], [histogram.num_above, 'above']]
      .filter(([count]) => count > 0).map(([count, where]) => ` ${count} more ${where} the range shown.`);
  byId(captionId).textContent = meaning + strays.join('');
}

// One bar per image; the central one is highlighted.
function imageChart(id, captionId, title, unit, images, value, meaning) {
  addChart(id, title, {
    type: 'bar',
    data: {
      labels: images.map(image => image.name),
      datasets: [{
        data: images.map(value),
        backgroundColor: images.map(image => image.central ? CHART_ACCENT : pageColour('--accent')),
      }],
    },
    options: {
      scales: {
        x: {ticks: {maxRotation: 60, autoSkip: true,
                    maxTicksLimit: byId(id).parentElement.clientWidth < 420 ? 7 : 16}, grid: {display: false}},
        y: axis(unit, {beginAtZero: true}),
      },
    },
  });
  byId(captionId).textContent = `${meaning} The central frame is orange.`;
}

function scaleChart(data) {
  const known = data.markers.filter(marker => marker.scale_deviation_percent !== undefined);
  // Round steps from zero, so that zero has its line.
  const largest = Math.max(1e-3, ...known.map(marker => Math.abs(marker.scale_deviation_percent)));
  const step = roundUp(largest / 3), end = step * Math.ceil(largest / step);
  addChart('chart_scale', 'Scale by marker', {
    type: 'scatter',
    data: {
      datasets: [{
        data: known.map(marker => ({x: marker.id, y: marker.scale_deviation_percent})),
        backgroundColor: pageColour('--accent'), pointRadius: 3.5,
      }],
    },
    options: {
      scales: {
        x: axis('marker id', {ticks: {precision: 0}}),
        y: axis('deviation, %', {min: -end, max: end, ticks: {stepSize: step, autoSkip: false}, grid: {
          color: context => pageColour(context.tick.value === 0 ? '--quiet' : '--line')}}),
      },
      plugins: {tooltip: {callbacks: {
        label: item => `marker ${item.raw.x}: ${fixed(item.raw.y, 2)} %`}}},
    },
  });
  byId('caption_scale').textContent =
      `Deviation of the scale from each marker alone from the scale of the shape (${
        significant(data.scale.m_per_unit, 6)} m per unit of the model). A marker far from zero is ` +
      'badly printed, bent, misread, or has another size than in the layout.';
}

function fillCharts(data) {
  histogramChart('chart_area', 'caption_area', 'Marker area', '%',
      data.histograms.area_deviation_percent,
      'Difference of each marker\'s area from the printed one. A common shift is an error of scale.');
  histogramChart('chart_error', 'caption_error', 'Reprojection error', 'px', data.histograms.error_px,
      'Distance of each detected corner from its projection.');
  if (data.images.some(image => image.marker_ratio !== undefined)) {
    imageChart('chart_ratio', 'caption_ratio', 'Markers seen by image', '%', data.images,
        image => 100 * image.marker_ratio, 'Of the layout\'s markers, those seen whole in the image.');
  } else {
    imageChart('chart_ratio', 'caption_ratio', 'Markers seen by image', 'markers', data.images,
        image => image.num_markers, 'Markers seen whole in the image.');
  }
  imageChart('chart_residual', 'caption_residual', 'Mean reprojection error by image', 'px', data.images,
      image => image.error_mean_px, 'An image far above the others is blurred or has a wrong pose.');
  scaleChart(data);
}

// Gives both axes the same scale by extending one range around its middle.
function fitEqualScales(chart) {
  const {width, height} = chart.chartArea;
  const all = chart.data.datasets.flatMap(set => set.data);
  const range = key => {
    const values = all.map(point => point[key]);
    const [min, max] = [Math.min(...values), Math.max(...values)];
    return {middle: (min + max) / 2, length: 1.04 * (max - min)};
  };
  const ranges = {x: range('x'), y: range('y')};
  const perPixel = Math.max(ranges.x.length / width, ranges.y.length / height);
  for (const [key, pixels] of [['x', width], ['y', height]]) {
    const half = perPixel * pixels / 2;
    Object.assign(chart.options.scales[key], {min: ranges[key].middle - half, max: ranges[key].middle + half});
  }
  chart.update();
}

// Omits ticks at the ends of an axis that are no round numbers.
const ROUND_TICKS = {ticks: {includeBounds: false}};

// The curves are wide and flat, so the height of the chart follows from its width.
function fitHeight(chart, points, numLegends) {
  const box = chart.canvas.parentElement;
  const length = key => {
    const values = points.flat().map(point => point[key]);
    return Math.max(...values) - Math.min(...values);
  };
  const {width, height} = chart.chartArea;
  const least = chart.options.plugins.legend.position === 'right' ? 18 * numLegends - 30 : 50;
  const wanted = Math.min(420, Math.max(50, least, 1.15 * width * length('y') / length('x')));
  box.style.height = `${Math.round(box.offsetHeight - height + wanted)}px`;
}

const legendPlace = box => box.clientWidth < 560 ? 'bottom' : 'right';

const sectionName = section => `${section.name}, ${fixed(section.height_m, 2)} m`;

// The chart as a drawing, both axes to one scale, in mm.
function sectionSvg(sections) {
  const all = sections.flatMap(section => [...section.profile, ...section.design ?? []]);
  const [low, high] = [0, 1].map(i => [Math.min, Math.max].map(f => 1e3 * f(...all.map(x => x[i]))))
      .reduce((ends, [min, max]) => [[...ends[0], min], [...ends[1], max]], [[], []]);
  const size = Math.max(high[0] - low[0], high[1] - low[1]) / 40;
  const height = high[1] - low[1] + (sections.length + 2) * 1.5 * size;
  const svg = svgElement('svg', {
    xmlns: SVG, viewBox: [low[0] - size, -high[1] - size, high[0] - low[0] + 2 * size, height + 2 * size].join(' '),
    'font-family': 'sans-serif', 'font-size': size, fill: 'none', 'stroke-width': size / 10});
  sections.forEach((section, i) => {
    const stroke = PART_COLOURS[i % PART_COLOURS.length];
    const path = (curve, more) => svgElement('path', {stroke, ...more, d: curve.map(
        ([x, y], k) => `${k ? 'L' : 'M'}${fixed(1e3 * x, 2)} ${fixed(-1e3 * y, 2)}`).join('')});
    if (section.design) svg.append(path(section.design, {'stroke-dasharray': size / 2}));
    svg.append(path(section.profile),
        svgElement('text', {x: low[0], y: -low[1] + (i + 2) * 1.5 * size, fill: stroke},
            `${sectionName(section)}: camber ${fixed(section.camber_percent, 2)} %${
              section.twist_deg === undefined ? '' : `, twist ${fixed(section.twist_deg, 1)}°`}`));
  });
  return svg;
}

// The curve of a section in the chart; `more` are settings of its line.
function sectionCurve(section, i, curve, more) {
  const colour = PART_COLOURS[i % PART_COLOURS.length];
  return {
    label: sectionName(section), data: curve.map(([x, y]) => ({x: x * 1e3, y: y * 1e3})), showLine: true,
    pointRadius: 0, borderWidth: 2, borderColor: colour, backgroundColor: colour, ...more};
}

function sectionChart(sections) {
  const measured = sections.map((section, i) => sectionCurve(section, i, section.profile));
  const designs = sections.flatMap((section, i) => section.design ?
      [sectionCurve(section, i, section.design, {borderDash: [6, 4], borderWidth: 1.5, isDesign: true})] : []);
  const points = [...measured, ...designs].map(set => set.data);
  const position = legendPlace(byId('chart_sections').parentElement);
  const chart = addChart('chart_sections', 'Profiles, both axes to one scale', {
    type: 'scatter',
    data: {
      datasets: [...measured, ...designs],
    },
    options: {
      scales: {x: axis('along the chord, mm', ROUND_TICKS), y: axis('mm', ROUND_TICKS)},
      plugins: {legend: {display: true, position, labels: {
        boxWidth: 18, boxHeight: 2, filter: (item, data) => !data.datasets[item.datasetIndex].isDesign}}},
    },
  });
  const fit = () => {
    fitHeight(chart, points, measured.length);
    chart.resize();
    fitEqualScales(chart);
  };
  fit();
  addSaving(chart, 'SVG', 'save the profiles as a drawing', () => saveSvg(sectionSvg(sections), 'profiles'));
  // Fitting changes the height, which must not be seen as another change.
  let width = 0;
  chart.observer = new ResizeObserver(([{contentRect}]) => {
    if (contentRect.width === width) return;
    width = contentRect.width;
    requestAnimationFrame(() => {
      if (!charts.includes(chart)) return;
      chart.options.plugins.legend.position = legendPlace(chart.canvas.parentElement);
      chart.resize();
      fit();
    });
  });
  chart.observer.observe(chart.canvas.parentElement);
}
