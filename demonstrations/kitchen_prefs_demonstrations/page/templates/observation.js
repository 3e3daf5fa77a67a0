// What a decision observes, as kitchen_prefs/envs/observations.py packs it: a row of 13 numbers for
// each visible instance. Python draws the order of the rows; here they are in order of their ids.

const COLUMNS = 13;
const [EXTENTS, POSITION, QUATERNION, DECISION, IS_OBJECT, IS_PLACE] = [0, 3, 6, 10, 11, 12];
const POSE_SIZE = 7;

const float32sOf = (base64) => new Float32Array(bytesOf(base64).buffer);
const poseOf = (poses, i) => poses.subarray(i * POSE_SIZE, (i + 1) * POSE_SIZE);
const PLACEMENT_POSES = {
  bottom: float32sOf(data.observed.placements.bottom),
  top: float32sOf(data.observed.placements.top),
};

/** A row of the set. */
function instanceRow(extents, pose, decision, isPlace) {
  const row = new Float32Array(COLUMNS);
  row.set(extents, EXTENTS);
  row.set(pose, POSITION);
  row[DECISION] = decision;
  row[isPlace ? IS_PLACE : IS_OBJECT] = 1;
  return row;
}

/**
 * The instances that a decision sees: door, racks, dishes, and places while a dish is in hand.
 * `session` has the exact poses of its dishes; `decision` is the number of decisions before.
 */
function observe(state, session, decision) {
  const seen = [...fixtures(state), ...dishesInView(state, session), ...placesInView(state)];
  return {
    rows: seen.map(([, extents, pose, isPlace]) =>
      instanceRow(extents, pose, decision, isPlace)),
    ids: seen.map(([id]) => id),
  };
}

function fixtures(state) {
  const { door, racks } = data.observed;
  const fixture = (id, of, moved) => [id, of.extents, of.poses[Number(moved)], false];
  return [
    fixture(DOOR, door, state.doorOpen),
    fixture(BOTTOM_RACK, racks.bottom, state.out === "bottom"),
    fixture(TOP_RACK, racks.top, state.out === "top"),
  ];
}

const extentsOf = (state, dish) => data.observed.extents[state.dishes[dish].category];

function dishesInView(state, session) {
  const onCounter = float32sOf(session.poses);
  return visibleDishes(state).map((dish) => {
    const rack = state.places[dish];
    const pose = rack === "counter" ? poseOf(onCounter, dish)
      : poseOf(PLACEMENT_POSES[rack], state.placements[dish]);
    return [FIRST_DISH + dish, extentsOf(state, dish), pose, false];
  });
}

/** The placements of the rack that is out, free or not, and the sink. */
function placesInView(state) {
  if (state.held === null) return [];
  const extents = extentsOf(state, state.held);
  const placements = placementsInHand(state).map((placement) =>
    [FIRST_PLACEMENT[state.out] + placement, extents,
      poseOf(PLACEMENT_POSES[state.out], placement), true]);
  return [...placements, [SINK, extents, data.observed.sink, true]];
}

/** The rows that a decision may choose: the places if there are any, else the objects. */
function choosable(rows) {
  const isPlaceDecision = rows.some((row) => row[IS_PLACE] > 0);
  const candidates = [...rows.keys()];
  return isPlaceDecision ? candidates.filter((i) => rows[i][IS_PLACE] > 0) : candidates;
}
