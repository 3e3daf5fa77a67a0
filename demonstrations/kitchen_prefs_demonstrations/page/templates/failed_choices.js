// The choices that have failed since the last success (common/failed_choices.py).

const SAME = 0.05; // m: the nearest row to a choice is the same instance if it is this near
const METRES_PER_RADIAN = 0.1; // weight of a rotation (envs/actions.py)

class FailedChoices {
  constructor() {
    this.choices = [];
  }

  /**
   * The indices of the rows that have failed. A last choice that can still be chosen has failed;
   * otherwise it succeeded, and all earlier failures are forgotten.
   */
  find(rows) {
    if (this.choices.length && sameRow(rows, this.choices.at(-1)) === null) this.choices = [];
    return new Set(this.choices.map((choice) => sameRow(rows, choice))
      .filter((row) => row !== null));
  }

  record(row) {
    this.choices.push(row);
  }
}

/** The index of the row that is the same instance as a choice, or null. */
function sameRow(rows, choice) {
  const candidates = choosable(rows).filter((i) => rows[i][IS_PLACE] === choice[IS_PLACE]);
  if (candidates.length === 0) return null;
  const [row, distance] = nearest(candidates, (i) => poseAngleDistance(rows[i], choice));
  return distance < SAME ? row : null;
}

function poseAngleDistance(row, choice) {
  const metres = distance3(positionOf(row), positionOf(choice));
  const parts = row.subarray(QUATERNION, DECISION);
  const cosine = Math.abs(parts.reduce((sum, part, k) => sum + part * choice[QUATERNION + k], 0));
  return metres + METRES_PER_RADIAN * 2 * Math.acos(Math.min(cosine, 1));
}
