function startTheme() {
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const showLabel = () => { byId("theme").textContent = dark() ? "Light" : "Dark"; };
  byId("theme").addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    showLabel();
  });
  showLabel();
}

function showFacts() {
  const episodes = Object.values(data.splits).reduce((sum, sessions) => sum + sessions, 0);
  byId("facts").textContent = [`${data.entries.length} entries`,
    `${SPLITS.length} test splits, ${episodes} episodes each`,
    `data version ${data.version}`].join(" \u00b7 ");
}

startTheme();
showFacts();
startTables();
drawCharts();
startFailureModes();
startViewer();
