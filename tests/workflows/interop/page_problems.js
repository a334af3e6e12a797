'use strict';

// Measures a page in each iframe: data-problems says what overlaps, is cut or cannot be read.

function problemsOf(frame, width) {
  const doc = frame.contentDocument;
  const problems = [];
  const shown = [...doc.querySelectorAll('.card, figure, .chart.wide, .table, #view, #picture')]
      .filter(item => !item.closest('details:not([open])'))
      .map(item => [item, item.getBoundingClientRect()]).filter(([, box]) => box.width > 0 && box.height > 0);
  const name = item => item.id || item.querySelector('[id]')?.id || item.textContent.slice(0, 20);
  for (const [a, p] of shown) {
    for (const [b, q] of shown) {
      if (a === b || a.contains(b) || b.contains(a)) continue;
      const isApart = p.right <= q.left + 1 || q.right <= p.left + 1 || p.bottom <= q.top + 1 || q.bottom <= p.top + 1;
      if (!isApart) problems.push(`${name(a)} and ${name(b)} overlap`);
    }
    if (p.left < 0 || p.right > width) problems.push(`${name(a)} reaches beyond the page`);
  }
  if (doc.documentElement.scrollWidth > width) problems.push('the page scrolls sideways');
  for (const canvas of doc.querySelectorAll('canvas')) {
    const box = canvas.getBoundingClientRect(), parent = canvas.parentElement.getBoundingClientRect();
    if (box.right > parent.right + 1 || box.bottom > parent.bottom + 1) problems.push(`${canvas.id || 'the view'} is cut: ${box.right} ${box.bottom} of ${parent.right} ${parent.bottom}`);
  }
  const view = doc.querySelector('#view').getBoundingClientRect();
  for (const label of doc.querySelectorAll('#view_axes span:not([hidden])')) {
    const box = label.getBoundingClientRect();
    const isCut = side => (box.left - side) * (box.right - side) < 0;
    if (isCut(view.left) || isCut(view.right)) problems.push(`the label '${label.textContent}' is cut`);
  }
  for (const cell of doc.querySelectorAll('th, td')) {
    const text = doc.createRange();
    text.selectNodeContents(cell);
    if (cell.textContent.length < 12 && text.getClientRects().length > 2) problems.push(`letters of '${cell.textContent}' stand under each other`);
  }
  doc.querySelector('#ids').click();
  const ids = [...doc.querySelectorAll('#view_ids span:not([hidden])')].map(id => [id.textContent, id.getBoundingClientRect()]);
  ids.forEach(([a, p], i) => ids.slice(0, i).forEach(([b, q]) => {
    if (Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1 && Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 1) problems.push(`the ids ${a} and ${b} overlap`);
  }));
  if (view.width > 0 && ids.length < 20) problems.push(`only ${ids.length} ids are shown`);
  if (!frame.contentWindow.Chart.getChart('chart_scale').scales.y.ticks.some(({value}) => value === 0)) problems.push('the scales have no line at zero');
  // What a screen scrolls, paper cuts.
  for (const box of doc.querySelectorAll('.table')) {
    const isPrinted = frame.contentWindow.getComputedStyle(box).overflowX === 'visible';
    if (isPrinted && box.scrollWidth > box.clientWidth) problems.push(`${box.id} is ${box.scrollWidth} px wide on ${box.clientWidth} px of paper`);
  }
  const chart = frame.contentWindow.Chart.getChart('chart_sections');
  const {x, y} = chart.scales;
  const scale = axis => (axis.max - axis.min) / (axis === x ? chart.chartArea.width : chart.chartArea.height);
  if (Math.abs(scale(x) / scale(y) - 1) > 0.02) problems.push(`the axes have scales ${scale(x)} and ${scale(y)}`);
  if (chart.chartArea.height < 40) problems.push('the profiles are flat');
  return problems.map(problem => `${width} px: ${problem}`);
}
for (const frame of document.querySelectorAll('iframe')) {
  frame.addEventListener('load', () => setTimeout(() => {
    frame.dataset.problems = problemsOf(frame, Number(frame.width)).join('; ') || 'none';
  }, 300));
}
