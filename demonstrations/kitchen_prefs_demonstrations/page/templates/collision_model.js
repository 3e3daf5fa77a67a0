// Which places are blocked: learned shapes collide or do not (common/collision_model.py).

const LARGEST_DISH = 0.4; // m, from corner to corner; the door and the racks are larger
const REACH = LARGEST_DISH;
const SHARPNESS = 500; // 1 / m
const RINGS = [[0.9, -0.9], [0.9, 0], [0.9, 0.9], [0.45, -0.9]]; // radius and height, in halves
const SPHERES_OF_A_RING = 6;
const OUTPUT_SCALE = 6;
const SPHERE_RADIUS = 0.004; // m

/** The initial centres of a shape's spheres, in halves of the extents. */
const CYLINDER = [...RINGS.flatMap(([radius, height]) =>
  Array.from({ length: SPHERES_OF_A_RING }, (_, i) => {
    const angle = (i * 2 * Math.PI) / SPHERES_OF_A_RING;
    return [radius * Math.cos(angle), radius * Math.sin(angle), height];
  })), [0, 0, -0.9]];

const distance3 = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const positionOf = (row) => row.subarray(POSITION, QUATERNION);

function isDish(row) {
  return row[IS_OBJECT] > 0 && Math.sqrt(dot3(row, row, EXTENTS)) < LARGEST_DISH;
}

class CollisionModel {
  constructor(weights) {
    this.layers = [0, 2].map((i) => weightsOf(weights, `layers.${i}`));
  }

  /** The log-probability that no dish of the set blocks a row; 0 for rows that are no places. */
  logFree(rows) {
    const dishes = rows.filter(isDish);
    const shapes = new Map(rows.map((row) => [row, null]));
    const shapeOf = (row) => {
      if (shapes.get(row) === null) shapes.set(row, this.shape(row));
      return shapes.get(row);
    };
    return rows.map((row) => {
      if (row[IS_PLACE] === 0) return 0;
      const near = dishes.filter((dish) => distance3(positionOf(row), positionOf(dish)) < REACH);
      return near.reduce((sum, dish) =>
        sum + logSigmoid(SHARPNESS * signedDistance(shapeOf(row), shapeOf(dish))), 0);
    });
  }

  /** The spheres of an instance in the kitchen: x, y, z and radius of each, in m. */
  shape(row) {
    const extents = row.slice(EXTENTS, POSITION);
    const [first, second] = this.layers;
    const hidden = mapped(linear(first, matrixOf([extents.map((extent) => extent * 10)])), gelu);
    const learned = linear(second, hidden).values.map((value) => value * OUTPUT_SCALE);
    const rotate = rotation(row.subarray(QUATERNION, DECISION));
    return CYLINDER.map((centre, i) => {
      const inMetres = centre.map((part, axis) =>
        (part + Math.tanh(learned[4 * i + axis]) / 2) * (extents[axis] / 2));
      const [x, y, z] = rotate(inMetres).map((part, axis) => part + row[POSITION + axis]);
      return [x, y, z, SPHERE_RADIUS * Math.exp(Math.min(learned[4 * i + 3], 2))];
    });
  }
}

/** The signed distance of two shapes' nearest spheres in m, negative where they overlap. */
function signedDistance(shape, other) {
  let least = Infinity;
  for (const a of shape) {
    for (const b of other) {
      const [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
      least = Math.min(least, Math.sqrt(x * x + y * y + z * z) - a[3] - b[3]);
    }
  }
  return least;
}

/** The rotation of a unit quaternion (wxyz). */
function rotation([w, x, y, z]) {
  const matrixRows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
  return ([a, b, c]) => matrixRows.map(([p, q, r]) => p * a + q * b + r * c);
}
