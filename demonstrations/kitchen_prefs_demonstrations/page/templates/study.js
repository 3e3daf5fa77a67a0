// The page as a study's instrument, `?study=NAME`: the same kitchen for everybody, no policy.

const study = {
  name: new URLSearchParams(location.search).get("study") ?? data.study,
  participant: "",
  day: 1,
};

/** Ask for consent, a code and the day; then the kitchen is there. */
function startStudy() {
  document.body.classList.add("study");
  byId("lead").textContent = "Load the dishwasher as you would at home. There is no right way.";
  byId("consent-text").textContent = data.consent.replaceAll("STUDY", study.name);
  byId("consent").hidden = false;
  byId("stages").hidden = true;
  byId("consent").addEventListener("submit", (event) => {
    event.preventDefault();
    study.participant = byId("participant").value;
    study.day = Number(byId("day").value);
    byId("consent").hidden = true;
    byId("stages").hidden = false;
    goOn(remembered(), "study");
    byId("you").focus();
  });
}

/** Why a study cannot be run under this name, or an empty string. */
function troubleWithStudy() {
  if (study.name === null || /^[A-Za-z0-9_-]{1,60}$/.test(study.name)) return "";
  return "A study's name in the address has 1 to 60 letters, digits, hyphens and underscores.";
}
