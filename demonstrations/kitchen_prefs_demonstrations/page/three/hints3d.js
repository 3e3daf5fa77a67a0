// What helps the visitor in three dimensions: marks of placements, a ghost, a glow and a label.

const FREE_COLOUR = "#35b37e";
const BLOCKED_COLOUR = "#d1495b";
const GLOW = 0.22; // of the thing under the pointer

class Hints3D {
  constructor(stage, model) {
    this.stage = stage;
    this.model = model;
    this.glowing = null;
    this.ghost = null;
    this.marks = [];
    this.label = html("div", { class: "told", "aria-hidden": "true", hidden: "" });
    stage.element.append(this.label);
  }

  /** Discs where the dish in hand may stand, crosses where another dish is in the way. */
  mark(placements, rack) {
    this.marks.forEach((mark) => {
      mark.removeFromParent();
      mark.geometry.dispose();
    });
    const free = placements.filter(({ blocked }) => !blocked);
    const blocked = placements.filter((placement) => placement.blocked);
    this.marks = [
      marksAt(free, new THREE.CircleGeometry(0.011, 24), FREE_COLOUR, 0.9),
      marksAt(blocked, new THREE.PlaneGeometry(0.026, 0.005), BLOCKED_COLOUR, 0.8),
      marksAt(blocked, new THREE.PlaneGeometry(0.005, 0.026), BLOCKED_COLOUR, 0.8),
    ];
    if (placements.length) this.model.racks[rack].add(...this.marks);
  }

  /** A ghost of a dish at a pose in the frame of `parent`. */
  haunt(template, parent, { position, quaternion }, blocked) {
    this.ghost = template.clone();
    this.ghost.material = new THREE.MeshBasicMaterial({
      color: blocked ? BLOCKED_COLOUR : FREE_COLOUR, transparent: true, opacity: 0.55,
    });
    this.ghost.castShadow = false;
    this.ghost.position.copy(position);
    this.ghost.quaternion.copy(quaternion);
    parent.add(this.ghost);
  }

  glow(object) {
    this.glowing = object;
    this.setGlow(GLOW);
  }

  /** Take ghost, glow and label away. */
  clear() {
    this.ghost?.removeFromParent();
    this.ghost = null;
    this.setGlow(0);
    this.glowing = null;
    this.label.hidden = true;
  }

  setGlow(strength) {
    this.glowing?.traverse(({ material }) => material?.emissive?.setScalar(strength));
  }

  /** Words beside the pointer, within the canvas. */
  tell(text, { x, y }) {
    this.label.textContent = text;
    this.label.hidden = text === "";
    const left = Math.max(Math.min(x + 14, this.stage.width - this.label.offsetWidth - 4), 4);
    const top = y > 40 ? y - 36 : y + 22;
    this.label.style.transform = `translate(${left}px, ${top}px)`;
  }
}

/** One shape at every placement, on the rack's floor and seen through its wires. */
function marksAt(placements, shape, color, opacity) {
  const paint = { color, opacity, transparent: true, depthTest: false };
  const marks = new THREE.InstancedMesh(
    shape, new THREE.MeshBasicMaterial(paint), placements.length,
  );
  placements.forEach(({ pose: { position } }, i) => {
    marks.setMatrixAt(i, new THREE.Matrix4().setPosition(position.x, position.y, 0.004));
  });
  marks.renderOrder = 1;
  return marks;
}
