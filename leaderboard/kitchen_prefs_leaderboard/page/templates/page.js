function tierFacts({ title, splits, version }) {
  const episodes = Object.values(splits).reduce((sum, sessions) => sum + sessions, 0);
  return `${title}: ${Object.keys(splits).length} test splits, ${episodes} episodes each, `
    + `data version ${version}`;
}

function showFacts() {
  const facts = [`${data.entries.length} entries`, ...Object.values(data.tiers).map(tierFacts)];
  byId("facts").textContent = facts.join(" \u00b7 ");
}

/** Charts and the viewer, of which a page without entries that they can draw has none. */
function startDrawings() {
  const some = data.entries.some(isDrawn);
  for (const id of ["charts", "episodes"]) {
    byId(id).hidden = !some;
    document.querySelector(`nav [href="#${id}"]`).hidden = !some;
  }
  if (!some) return;
  drawCharts();
  startViewer();
}

startTheme(byId("theme"));
showFacts();
startTables();
startFailureModes();
startDrawings();
