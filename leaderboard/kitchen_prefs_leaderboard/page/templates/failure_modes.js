/** In how many episodes of a split a failure mode occurs; a click opens them in the viewer. */
function failureModeCell(index, split, mode) {
  const times = data.entries[index].failure_modes[split][mode];
  if (times === 0) return html("td", { class: "number none" }, "0");
  const share = Math.round((100 * times) / data.splits[split]);
  const click = () => openEpisodes(index, split, `mode:${mode}`);
  const title = `${times} episodes of ${words(split)}: ${data.failure_modes[mode]}`;
  const open = html("button", { type: "button", click, "aria-label": title }, String(times));
  const small = html("small", {}, share ? `${share} %` : "< 1 %");
  const cell = html("td", { class: "number tinted" }, open, small);
  cell.style.setProperty("--share", `${0.4 * share}%`); // the text stays readable on it
  return cell;
}

function drawFailureModes() {
  const index = Number(byId("failure-modes-entry").value);
  const heads = SPLITS.map((split) => html("th", { scope: "col", class: "number" }, words(split),
    html("small", {}, `of ${data.splits[split]}`)));
  const rows = data.failure_modes.map((name, mode) => html("tr", {},
    html("th", { scope: "row" }, name),
    ...SPLITS.map((split) => failureModeCell(index, split, mode))));
  const title = `Failure modes of ${nameOf(index)}`;
  byId("failure-modes-table").replaceChildren(html("table", { class: "failure-modes" },
    html("caption", { class: "unseen" }, title),
    html("thead", {}, html("tr", {}, html("th", { scope: "col" }, "Episodes"), ...heads)),
    html("tbody", {}, ...rows)));
}

function startFailureModes() {
  setOptions(byId("failure-modes-entry"), entryChoices());
  byId("failure-modes-entry").addEventListener("change", drawFailureModes);
  drawFailureModes();
}
