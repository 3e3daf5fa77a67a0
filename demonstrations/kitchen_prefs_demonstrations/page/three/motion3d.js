// Short movements: a door that folds down, racks that slide, dishes that are carried.

const MOTION = 350; // milliseconds

const movesLess = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

class Motions3D {
  constructor() {
    this.running = new Map(); // by the object that moves
  }

  /** Move an object to a pose in its parent's frame, `lift` m higher in the middle of its way. */
  move(object, { position, quaternion }, lift = 0) {
    const from = { position: object.position.clone(), quaternion: object.quaternion.clone() };
    this.running.set(object, { from, to: { position, quaternion }, lift, start: null });
  }

  /** Put an object where it belongs at once. */
  put(object, { position, quaternion }) {
    this.running.delete(object);
    object.position.copy(position);
    object.quaternion.copy(quaternion);
  }

  /** Where everything is at a time in milliseconds; whether something has moved. */
  advance(time) {
    const moving = this.running.size > 0;
    for (const [object, motion] of this.running) {
      motion.start ??= time;
      const part = Math.min((time - motion.start) / MOTION, 1);
      const eased = part * part * (3 - 2 * part);
      const { from, to, lift } = motion;
      object.position.lerpVectors(from.position, to.position, eased);
      object.position.z += lift * Math.sin(Math.PI * eased);
      object.quaternion.slerpQuaternions(from.quaternion, to.quaternion, eased);
      if (part === 1) this.put(object, to);
    }
    return moving;
  }
}
