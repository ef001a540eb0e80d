() => {
  const root = document.querySelector("#map");
  const heat = root.calcdata.map((one) => one[0]).find((one) => one.trace.type === "heatmap");
  let [best, row, column] = [-1, 0, 0];
  heat.z.forEach((line, i) => Array.from(line).forEach((one, j) => { if (one > best) [best, row, column] = [one, i, j]; }));
  const { xaxis, yaxis } = root._fullLayout;
  const down = yaxis._offset + yaxis.c2p(heat.yCenter[row]);
  const scrolled = root.closest(".scrolled");
  scrolled.scrollTop = down - scrolled.clientHeight / 2;
  const box = root.getBoundingClientRect();
  return { x: box.x + xaxis._offset + xaxis.c2p(heat.xCenter[column]), y: box.y + down, name: heat.trace.y[row], frequency: Array.from(heat.trace.customdata[row][column])[1] };
}
