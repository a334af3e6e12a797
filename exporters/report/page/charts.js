'use strict';

// The charts, drawn by Chart.js.

const charts = [];

function setChartDefaults() {
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.color = '#3b4854';
  Chart.defaults.borderColor = '#e3e8ec';
  Chart.defaults.plugins.legend.display = false;
  // A canvas keeps its size when printed; fit it to the page and back.
  window.addEventListener('beforeprint', () => charts.forEach(chart => chart.resize()));
  window.addEventListener('afterprint', () => charts.forEach(chart => chart.resize()));
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
  const save = element('button', {type: 'button', className: 'save screen_only', textContent: 'PNG',
                                  title: `save the chart "${title}" as a picture`});
  save.addEventListener('click', () => savePicture(chart.canvas, title));
  byId(id).parentElement.append(save);
  return chart;
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
        backgroundColor: CHART_COLOUR, barPercentage: 1, categoryPercentage: 0.96,
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
        backgroundColor: images.map(image => image.central ? CHART_ACCENT : CHART_COLOUR),
      }],
    },
    options: {
      scales: {
        x: {ticks: {maxRotation: 60, autoSkip: true, maxTicksLimit: 16}, grid: {display: false}},
        y: axis(unit, {beginAtZero: true}),
      },
    },
  });
  byId(captionId).textContent = `${meaning} The central image is orange.`;
}

function scaleChart(data) {
  const known = data.markers.filter(marker => marker.scale_deviation_percent !== undefined);
  addChart('chart_scale', 'Scale by marker', {
    type: 'scatter',
    data: {
      datasets: [{
        data: known.map(marker => ({x: marker.id, y: marker.scale_deviation_percent})),
        backgroundColor: CHART_COLOUR, pointRadius: 3.5,
      }],
    },
    options: {
      scales: {
        x: axis('marker id', {ticks: {precision: 0}}),
        y: axis('deviation, %', {grid: {
          color: context => context.tick.value === 0 ? '#3b4854' : '#e3e8ec'}}),
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

function sectionChart(sections) {
  const points = sections.map(section => section.profile.map(([x, y]) => ({x: x * 1e3, y: y * 1e3})));
  const chart = addChart('chart_sections', 'Profiles, both axes to one scale', {
    type: 'scatter',
    data: {
      datasets: sections.map((section, i) => ({
        label: section.name, data: points[i], showLine: true, pointRadius: 0, borderWidth: 2,
        borderColor: PART_COLOURS[i % PART_COLOURS.length],
        backgroundColor: PART_COLOURS[i % PART_COLOURS.length],
      })),
    },
    options: {
      scales: {x: axis('along the chord, mm', ROUND_TICKS), y: axis('mm', ROUND_TICKS)},
      plugins: {legend: {display: true, position: 'right'}},
    },
  });
  fitEqualScales(chart);
  new ResizeObserver(() => fitEqualScales(chart)).observe(byId('chart_sections').parentElement);
}
