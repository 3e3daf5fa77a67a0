// Snaps rows to the extents and poses that demonstrations showed (common/denoising.py). What is
// exact stays as it is, as long as demonstrations showed it.

const [UNKNOWN_EXTENTS, UNKNOWN_POSE] = [0.25, 0.05]; // relative; m
const PLACE_SIZE = 10; // extents and pose

class Denoiser {
  /** `places` are extents and poses, padded with zeros. */
  constructor(places) {
    this.categories = new Map(); // extents in words -> extents and the poses of its places
    for (let i = 0; i < places.shape[0]; i += 1) {
      const place = places.values.subarray(i * PLACE_SIZE, (i + 1) * PLACE_SIZE);
      if (place.some((value) => value !== 0)) this.add(place);
    }
  }

  add(place) {
    const extents = place.subarray(EXTENTS, POSITION);
    const known = this.categories.get(extents.join()) ?? { extents, poses: [] };
    known.poses.push(place.subarray(POSITION));
    this.categories.set(extents.join(), known);
  }

  denoise(rows) {
    return this.categories.size === 0 ? rows : rows.map((row) => this.snap(row));
  }

  snap(row) {
    const [{ extents, poses }, difference] = nearest([...this.categories.values()],
      (category) => extentsDifference(row, category.extents));
    if (difference >= UNKNOWN_EXTENTS) return row;
    const snapped = row.slice();
    snapped.set(extents, EXTENTS);
    const [pose, distance] = nearest(poses, (one) => poseDistance(row, one));
    if (distance < UNKNOWN_POSE) snapped.set(pose, POSITION);
    return snapped;
  }
}

/** The candidate at which a function is least, and its value there. */
function nearest(candidates, measure) {
  const values = candidates.map(measure);
  const least = Math.min(...values);
  return [candidates[values.indexOf(least)], least];
}

/** The largest relative difference of three extents, as the logarithm of their ratio. */
function extentsDifference(row, extents) {
  const logs = [...extents].map((extent, k) => Math.abs(Math.log(Math.max(row[k] / extent, 1e-6))));
  return Math.max(...logs);
}

/** The distance of two poses; a unit of the quaternion counts as a metre. */
function poseDistance(row, pose) {
  return Math.sqrt(pose.reduce((sum, value, k) => sum + (value - row[POSITION + k]) ** 2, 0));
}
