const SPLITS = Object.keys(data.sessions); // those whose sessions can be drawn
const TRACKS = {
  standard: "Trained on the training split alone; the prompt is demonstrations.",
  privileged: "The policy reads the preference's label.",
  language: "The policy reads the preference in words.",
  open: "Anything may be used, the simulator in training included.",
};

const tierOf = (entry) => data.tiers[entry.tier];
const splitsOf = (tier) => Object.keys(tier.splits);

/** Whether charts and the viewer can draw an entry's episodes. */
const isDrawn = ({ drawn }) => drawn !== null;

/** The entries as choices, each with its track, as names may repeat. */
function entryChoices(wanted = () => true) {
  const several = Object.keys(data.tiers).length > 1;
  return data.entries
    .map((entry, i) => {
      const { name, track } = entry.submission;
      return [i, `${name} (${several ? `${entry.tier}, ` : ""}${track})`];
    })
    .filter(([i]) => wanted(data.entries[i]));
}
