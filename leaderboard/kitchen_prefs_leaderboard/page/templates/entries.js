const SPLITS = Object.keys(data.splits);
const TRACKS = {
  standard: "Trained on train alone; the prompt is one demonstration.",
  privileged: "The policy reads the preference's label.",
  language: "The policy reads the preference in words.",
  open: "Anything may be used, the simulator in training included.",
};

/** The entries as choices, each with its track, as names may repeat. */
function entryChoices() {
  return data.entries.map(({ submission }, i) => [i, `${submission.name} (${submission.track})`]);
}
