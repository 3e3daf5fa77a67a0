// f_e: embeds each instance, of prompt and situation alike (ttp/network.py).

const FREQUENCIES = 8; // of each number; wavelengths halve (common/fourier_features.py)
const [POSITION_RANGE, QUATERNION_RANGE, EXTENTS_RANGE] = [4, 2, 1]; // the longest wavelengths
const MAX_DECISIONS = 256; // ttp/configuration_ttp.py

const fourierFrequencies = (longest) => Array.from({ length: FREQUENCIES },
  (_, k) => Math.fround(((2 * Math.PI) / longest) * 2 ** k));
const OF_POSITION = fourierFrequencies(POSITION_RANGE);
const OF_QUATERNION = fourierFrequencies(QUATERNION_RANGE);
const OF_EXTENTS = fourierFrequencies(EXTENTS_RANGE);

/** Frequencies from 1 to 1 / MAX_DECISIONS radians a decision. */
const timeFrequencies = (count) => Array.from({ length: count },
  (_, k) => Math.fround(MAX_DECISIONS ** (-k / (count - 1))));

/** The sines, then the cosines, of numbers; phases are rounded to float32 as in Python. */
function waves(numbers, frequencies) {
  const phases = [...numbers].flatMap((number) =>
    frequencies.map((frequency) => Math.fround(number * frequency)));
  return [...phases.map(Math.sin), ...phases.map(Math.cos)];
}

class InstanceEncoder {
  constructor(weights, dimTime) {
    this.ofTime = timeFrequencies(dimTime / 2);
    this.extents = [1, 3].map((i) => weightsOf(weights, `extents.layers.${i}`));
    this.pose = weightsOf(weights, "pose.linear");
    this.marker = weights["marker.table.weight"];
  }

  /** Embed rows: Phi_t(time) || Phi_c(category) || Phi_p(pose) || Phi_r(object or place). */
  embed(rows) {
    const categories = this.embedExtents(rows);
    const poses = this.embedPoses(rows);
    const embedded = rows.map((row, i) => [
      ...waves([row[DECISION]], this.ofTime),
      ...rowOf(categories, i),
      ...rowOf(poses, i),
      ...this.embedMarker(row),
    ]);
    return matrixOf(embedded);
  }

  embedExtents(rows) {
    const features = rows.map((row) => waves(row.subarray(EXTENTS, POSITION), OF_EXTENTS));
    const [first, second] = this.extents;
    return linear(second, mapped(linear(first, matrixOf(features)), gelu));
  }

  embedPoses(rows) {
    const features = rows.map((row) => [
      ...waves(row.subarray(POSITION, QUATERNION), OF_POSITION),
      ...waves(row.subarray(QUATERNION, DECISION), OF_QUATERNION),
    ]);
    return linear(this.pose, matrixOf(features));
  }

  embedMarker(row) {
    const size = this.marker.shape[1];
    const entry = row[IS_OBJECT] + 2 * row[IS_PLACE];
    return this.marker.values.subarray(entry * size, (entry + 1) * size);
  }
}
