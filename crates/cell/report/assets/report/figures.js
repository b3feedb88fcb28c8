// The plots: drawn by plotly.js in the colours of the page, with a cursor at the time of the scene.
const Figures = (() => {
  const { figures } = Data;
  const boxes = [...document.querySelectorAll('.plot')];
  let onTime = () => {};

  function themed(layout) {
    const themedLayout = { ...layout, paper_bgcolor: 'rgba(0,0,0,0)', plot_bgcolor: 'rgba(0,0,0,0)', autosize: true };
    themedLayout.font = { color: css('--ink'), family: 'system-ui, sans-serif', size: 12 };
    themedLayout.hoverlabel = { namelength: 40 };
    themedLayout.modebar = { bgcolor: 'rgba(0,0,0,0)', color: css('--faint'), activecolor: css('--ink') };
    for (const key of Object.keys(layout).filter((k) => /^[xy]axis\d*$/.test(k))) {
      themedLayout[key] = { ...layout[key], gridcolor: css('--rule'), linecolor: css('--rule'), tickcolor: css('--rule') };
    }
    return themedLayout;
  }

  function draw(box) {
    const figure = figures[Number(box.dataset.figure)];
    const options = { displaylogo: false, responsive: true, modeBarButtons: [['toImage', 'resetScale2d']] };
    Plotly.newPlot(box, figure.data, themed(structuredClone(figure.layout)), options);
    const cursor = document.createElement('div');
    cursor.className = 'cursor';
    box.append(cursor);
    box.cursor = figure.time ? cursor : null;
    if (figure.time) {
      // Anywhere over the plot, not only on a curve: plotly's own hover event needs a nearby point.
      box.addEventListener('mousemove', (event) => {
        const { xaxis } = box._fullLayout;
        const x = event.clientX - box.getBoundingClientRect().left - xaxis._offset;
        if (x >= 0 && x <= xaxis._length) onTime(xaxis.p2d(x));
      });
    }
    box.drawn = true;
  }

  // The cursor is an element over the plot: redrawing every plot at every frame would be too slow.
  function setTime(t) {
    for (const box of boxes) {
      const axes = box.cursor && box._fullLayout;
      if (!axes || box.offsetParent === null) continue;
      const x = axes.xaxis.l2p(t);
      const inside = x >= 0 && x <= axes.xaxis._length;
      box.cursor.style.display = inside ? 'block' : 'none';
      box.cursor.style.left = `${axes.xaxis._offset + x}px`;
      box.cursor.style.top = `${axes._size.t}px`;
      box.cursor.style.height = `${axes._size.h}px`;
    }
  }

  function showRun(run) {
    for (const card of document.querySelectorAll('[data-run]')) {
      card.hidden = Number(card.dataset.run) !== run;
    }
    for (const box of boxes) {
      if (box.offsetParent === null) continue;
      if (box.drawn) Plotly.Plots.resize(box);
      else draw(box);
    }
  }

  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    for (const box of boxes.filter((b) => b.drawn)) {
      Plotly.relayout(box, themed(structuredClone(figures[Number(box.dataset.figure)].layout)));
    }
  });

  return { showRun, setTime, onTime: (f) => { onTime = f; } };
})();
