const shown = new Set(); // the entries whose boxes are ticked

/** The columns that are chosen: all metrics of one split, or one metric on all splits. */
function columnsOf(tier) {
  const [kind, name] = tier.columns.value.split(":");
  if (kind === "split") return tier.metrics.map((metric) => column(tier, metric, metric, name));
  return [data.mean, ...splitsOf(tier)].map((split) => column(tier, words(split), name, split));
}

function column(tier, title, metric, split) {
  const note = metric === "Rescaled" ? referenceNote(tier, split) : "";
  return { title, note, values: (entry) => entry.metrics[split][metric] };
}

/** The headlines at which the rescaled headline of a split is 0 and 1. */
function referenceNote({ references }, split) {
  const { floor, ceiling } = references[split] ?? { floor: 0, ceiling: 1 };
  const digits = split in references ? 3 : 0;
  return `floor\u00a0${fixed(floor, digits)}, ceiling\u00a0${fixed(ceiling, digits)}`;
}

function rankOf(entry) {
  if (entry.rank === null) return "\u2013";
  return entry.tied ? `${entry.rank} =` : `${entry.rank}`;
}

function badges(entry) {
  const { verification } = entry;
  const isolated = verification !== null && verification.procedure > 1;
  const rerun = isolated ? "re-run" : "re-run, earlier procedure";
  return html(
    "span",
    { class: "badges" },
    html(
      "span",
      { class: isolated ? "badge good" : "badge" },
      verification === null ? "replayed only" : rerun,
    ),
  );
}

/** An entry's description, and the result of its re-run. */
function about(entry) {
  const { submission, verification } = entry;
  const { type, parameters, checkpoint, plugin } = submission.policy;
  const size = parameters === null ? "" : `, ${parameters.toLocaleString("en")} parameters`;
  const packages = Object.entries(submission.packages).map(([name, one]) => `${name} ${one}`);
  const facts = [
    ["By", submission.authors.join(", ")],
    ["Policy", type + size],
    ["Hardware", submission.hardware],
    ["Training", submission.training],
    ["Packages", packages.join(", ")],
    ["Submission", entry.digest],
  ];
  if (submission.link !== null) facts.splice(1, 0, ["Link", linkTo(submission.link)]);
  if (checkpoint !== null) facts.push(["Checkpoint", checkpoint]);
  if (plugin !== null) {
    facts.push(["Plug-in", `${plugin.distribution} ${plugin.version}, code ${plugin.code}`]);
  }
  if (verification !== null) facts.push(["Re-run", rerunText(tierOf(entry), verification)]);
  return html(
    "dl",
    { class: "about" },
    ...facts.flatMap(([term, fact]) => [html("dt", {}, term), html("dd", {}, fact)]),
  );
}

const ALIKE = 0.95; // kitchen_prefs_leaderboard/judgement.py

function rerunText({ ranking }, verification) {
  const { same, itself, replayed, rerun, fresh, salt, by, runs, alone, sandbox } = verification;
  const fresher = `fresh sessions (seed ${salt})`;
  const scores = [["replayed", replayed], ["re-run", rerun], [fresher, fresh]];
  const parts = scores.map(([name, { mean, low, high }]) =>
    `${name} ${fixed(mean)} (${fixed(low)} to ${fixed(high)})`);
  const percent = (share) => `${Math.round(100 * share)} %`;
  const stochastic = itself !== null && itself < ALIKE;
  const facts = [
    stochastic
      ? `It does not repeat itself: ${percent(itself)} of the episodes of two runs are alike`
      : `${percent(same)} of the episodes have the same decisions`,
    `${ranking}: ${parts.join(", ")}`,
  ];
  if (alone !== null) {
    const where = sandbox ? "a confined process" : "a process";
    facts.push(`By ${by}, in ${where} of its own, ${runs === 1 ? "once" : `${runs} times`}`);
    facts.push(stochastic ? `The ${ranking} shown is that of the run with each session alone`
      : `${percent(alone)} of the episodes that were rolled out alone went alike`);
  }
  return `${facts.join(". ")}.`;
}

function rowOf(entry, columns) {
  const index = data.entries.indexOf(entry);
  const { name, authors } = entry.submission;
  const tick = isDrawn(entry) ? [tickBox(index, name)] : [];
  const more = html("button", {
    type: "button",
    class: "more",
    "aria-expanded": "false",
    click: () => {
      row.about.hidden = !row.about.hidden;
      more.setAttribute("aria-expanded", !row.about.hidden);
    },
  }, name);
  const row = html(
    "tr",
    {},
    html("td", { class: "tick" }, ...tick),
    html("td", { class: "rank" }, rankOf(entry)),
    html("th", { scope: "row", class: "name" }, more,
      html("span", { class: "by" }, authors.join(", ")), badges(entry)),
    ...columns.map(({ values }) => numbers(values(entry))),
  );
  row.entry = entry;
  row.about = html("tr", { hidden: "" }, html("td"),
    html("td", { colspan: columns.length + 2 }, about(entry)));
  return row;
}

/** The box that puts an entry into the charts. */
function tickBox(index, name) {
  const box = html("input", {
    type: "checkbox",
    "aria-label": `Show ${name} in the charts`,
    change: () => {
      if (box.checked) shown.add(index);
      else shown.delete(index);
      drawCharts();
    },
  });
  box.checked = shown.has(index);
  return box;
}

function numbers(values) {
  if (values === undefined) return html("td", { class: "number none" }, "\u2013");
  const [mean, low, high] = values;
  return html("td", { class: "number" }, html("b", {}, fixed(mean)),
    html("small", {}, `${short(low)} to ${short(high)}`));
}

/** The sort key of each column, and whether large values come first. */
function sorters(columns) {
  return [
    { title: "Rank", key: (entry) => data.entries.indexOf(entry), down: false },
    { title: "Name", key: (entry) => entry.submission.name.toLowerCase(), down: false },
    ...columns.map(({ title, note, values }) => ({
      title, note, key: (entry) => (values(entry) ?? [-Infinity])[0], down: true, number: true,
    })),
  ];
}

function sortBy(table, header, { key }, down) {
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", down ? "descending" : "ascending");
  for (const block of table.tBodies) {
    const rows = [...block.rows].filter((row) => row.entry);
    rows.sort((a, b) => {
      const [one, other] = [key(a.entry), key(b.entry)];
      const order = one < other ? -1 : Number(one > other);
      return down ? -order : order;
    });
    block.append(...rows.flatMap((row) => [row, row.about]));
  }
}

function headerOf(table, sorter) {
  const header = html("th", { scope: "col", class: sorter.number ? "number" : "" });
  const click = () => {
    const now = header.getAttribute("aria-sort");
    sortBy(table, header, sorter, now ? now === "ascending" : sorter.down);
  };
  header.append(html("button", { type: "button", click }, sorter.title));
  if (sorter.note) header.append(html("small", { class: "note" }, sorter.note));
  return header;
}

/** A track's table: the ranked entries, then those without a re-run. */
function trackTable(track, entries, columns) {
  const table = html("table", {}, html("caption", { class: "unseen" }, `${track} track`));
  const headers = sorters(columns).map((sorter) => headerOf(table, sorter));
  headers[0].setAttribute("aria-sort", "ascending");
  const show = html("span", { class: "unseen" }, "Show");
  const tick = html("th", { scope: "col", class: "tick" }, show);
  table.append(html("thead", {}, html("tr", {}, tick, ...headers)));
  const ranked = entries.filter(({ rank }) => rank !== null);
  const rest = entries.filter(({ rank }) => rank === null);
  if (ranked.length) table.append(block("re-run", "", ranked, columns));
  if (rest.length) table.append(block("replayed only", ": no rank before a re-run", rest, columns));
  const title = `${track[0].toUpperCase()}${track.slice(1)} track`;
  return html(
    "section",
    { class: "track", "data-track": track },
    html("h4", {}, title, html("span", { class: "meaning" }, TRACKS[track])),
    html("div", { class: "scroll card", tabindex: 0, role: "region", "aria-label": title }, table),
  );
}

function block(title, remark, entries, columns) {
  const cell = html("th", { colspan: columns.length + 3, scope: "rowgroup" }, title, remark);
  return html("tbody", { "data-block": title }, html("tr", { class: "block" }, cell),
    ...entries.map((entry) => rowOf(entry, columns)).flatMap((row) => [row, row.about]));
}

/** The headlines of floor and ceiling on each split. */
function referenceTable({ title, headline, references, floor, ceiling }) {
  const splits = Object.keys(references);
  const head = (text, scope, name = "") => html("th", { scope, class: name }, text);
  const row = (name, policy) => html("tr", {},
    html("th", { scope: "row" }, `${name}: ${policy}`),
    ...splits.map((split) => html("td", { class: "number" }, fixed(references[split][name]))));
  return html("table", { class: "references" },
    html("caption", { class: "unseen" }, `${title}: ${headline} of floor and ceiling`),
    html("thead", {}, html("tr", {}, head(headline, "col"),
      ...splits.map((split) => head(words(split), "col", "number")))),
    html("tbody", {}, row("floor", floor), row("ceiling", ceiling)));
}

function drawTables() {
  for (const [name, tier] of Object.entries(data.tiers)) {
    const columns = columnsOf(tier);
    const ofTrack = (track) => data.entries.filter((entry) =>
      entry.tier === name && entry.submission.track === track);
    const tracks = Object.keys(TRACKS).filter((track) => ofTrack(track).length > 0);
    tier.tables.replaceChildren(
      ...tracks.map((track) => trackTable(track, ofTrack(track), columns)));
  }
  filterTables();
}

function matches({ submission }, text) {
  const { name, authors, policy, hardware, training } = submission;
  const description = [name, ...authors, policy.type, hardware, training].join("\n");
  return description.toLowerCase().includes(text);
}

/** Hide the rows that do not match, and tables and blocks without a visible row. */
function filterTables() {
  const text = byId("search").value.trim().toLowerCase();
  const track = byId("track").value;
  let found = 0;
  for (const section of document.querySelectorAll(".track")) {
    let ofTrack = 0;
    for (const body of section.querySelectorAll("tbody")) {
      const rows = [...body.rows].filter((row) => row.entry);
      for (const row of rows) {
        row.hidden = !matches(row.entry, text);
        const open = row.querySelector(".more").getAttribute("aria-expanded") === "true";
        row.about.hidden = row.hidden || !open;
      }
      const left = rows.filter((row) => !row.hidden).length;
      body.hidden = left === 0;
      ofTrack += left;
    }
    section.hidden = ofTrack === 0 || (track !== "all" && track !== section.dataset.track);
    if (!section.hidden) found += ofTrack;
  }
  byId("found").textContent = `${found} of ${data.entries.length} entries`;
}

/** At first the charts show the best three of each track. */
function tickBest() {
  const taken = {};
  data.entries.forEach((entry, index) => {
    if (!isDrawn(entry)) return;
    const { track } = entry.submission;
    taken[track] = (taken[track] ?? 0) + 1;
    if (taken[track] <= 3) shown.add(index);
  });
}

/** A tier's heading, its choice of columns and the place of its tables. */
function tierSection(tier) {
  const ofSplits = [data.mean, ...splitsOf(tier)].map((split) =>
    html("option", { value: `split:${split}` },
      split === data.mean ? "mean over the splits" : words(split)));
  const ofMetrics = tier.metrics.map((metric) =>
    html("option", { value: `metric:${metric}` }, `${metric} on every split`));
  tier.columns = html("select", { change: drawTables },
    html("optgroup", { label: "All metrics" }, ...ofSplits),
    html("optgroup", { label: "All splits" }, ...ofMetrics));
  tier.tables = html("div");
  const controls = html("div", { class: "controls" }, html("label", {}, "Columns ", tier.columns));
  return html("section", { class: "tier" }, html("h3", {}, tier.title), controls, tier.tables);
}

function startTables() {
  const tracks = [...new Set(data.entries.map(({ submission }) => submission.track))];
  setOptions(byId("track"), [["all", "all tracks"], ...tracks.map((track) => [track, track])]);
  byId("tables").replaceChildren(...Object.values(data.tiers).map(tierSection));
  byId("track").addEventListener("change", filterTables);
  byId("search").addEventListener("input", filterTables);
  byId("references").replaceChildren(...Object.values(data.tiers).map(referenceTable));
  tickBest();
  drawTables();
}
