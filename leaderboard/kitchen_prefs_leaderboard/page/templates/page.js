function showFacts() {
  const episodes = Object.values(data.splits).reduce((sum, sessions) => sum + sessions, 0);
  byId("facts").textContent = [`${data.entries.length} entries`,
    `${SPLITS.length} test splits, ${episodes} episodes each`,
    `data version ${data.version}`].join(" \u00b7 ");
}

startTheme(byId("theme"));
showFacts();
startTables();
drawCharts();
startFailureModes();
startViewer();
