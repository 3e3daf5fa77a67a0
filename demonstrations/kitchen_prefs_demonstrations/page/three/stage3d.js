// Camera, light and canvas of the kitchen in three dimensions. It draws when something has changed.

// The view of the project's own renderer (kitchen_model.py): from the front right.
const VIEW_FROM = [1.48, -3.15, 1.34];
const VIEW_ANGLE = 30; // degrees, vertical
const VIEW_MIDDLE = [-0.68, 0, 0.69]; // m
const IN_VIEW = [ // m: the counter's ends, the plants above it and the edge of the open door
  [-2.42, -0.04, 0], [1.02, -0.04, 0], [-2.42, -0.04, 0.95], [1.02, -0.04, 0.95],
  [-2.42, 0.65, 1.1], [0.22, 0.55, 1.75], [-0.3, -0.76, 0.1], [0.3, -0.76, 0.1],
];
const ORBIT = { azimuth: 1.0, highest: 0.35, lowest: 1.5, nearest: 1.0 }; // radians and m
const LOOK_AT = [[-2.2, -0.4, 0.3], [0.9, 0.1, 1.1]]; // m: the camera turns round a point in here
const LIGHTS = { // a colour and how bright it is
  light: { wall: "#d7c8b1", sky: ["#ffffff", 2.3], ground: "#cbbca8", sun: ["#fff2de", 1.6] },
  dark: { wall: "#8d7869", sky: ["#b7c2dc", 1.0], ground: "#6a5a4c", sun: ["#ffd2a0", 1.25] },
};
const SUN_FROM = [-2.0, -2.64, 3.2]; // m from the middle: the renderer's window, at the front left
const SHADOW_SIDE = 2048; // pixels
const SHADOW_REACH = 2.3; // m around the middle of the kitchen
const FINEST = 2; // pixels of the canvas for one of the page

class Stage3D {
  /** `beforeFrame(time)` moves what moves, and tells whether it has moved something. */
  constructor(element, beforeFrame) {
    this.element = element;
    this.beforeFrame = beforeFrame;
    this.frame = null;
    this.scene = new THREE.Scene();
    this.renderer = new THREE.WebGLRenderer({ antialias: true });
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("role", "img");
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.autoUpdate = false; // an orbiting camera leaves them as they are
    element.append(this.canvas);
    this.addLights();
    this.addCamera();
    this.follow();
  }

  addLights() {
    this.sky = new THREE.HemisphereLight();
    this.sky.position.set(0, 0, 1);
    this.sun = new THREE.DirectionalLight();
    this.sun.target.position.set(...VIEW_MIDDLE);
    this.sun.position.set(...SUN_FROM).add(this.sun.target.position);
    const { shadow } = this.sun;
    this.sun.castShadow = true;
    shadow.mapSize.set(SHADOW_SIDE, SHADOW_SIDE);
    shadow.radius = 3; // pixels of its soft edge
    shadow.normalBias = 0.004; // m, and a depth: no surface throws a shadow onto itself
    shadow.bias = -0.0004;
    [shadow.camera.left, shadow.camera.right] = [-SHADOW_REACH, SHADOW_REACH];
    [shadow.camera.bottom, shadow.camera.top] = [-SHADOW_REACH, SHADOW_REACH];
    [shadow.camera.near, shadow.camera.far] = [1.5, 8]; // m from the sun
    this.scene.add(this.sky, this.sun, this.sun.target);
  }

  addCamera() {
    this.camera = new THREE.PerspectiveCamera(VIEW_ANGLE, 1, 0.1, 40);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    const { controls } = this;
    this.canvas.style.touchAction = "pan-y"; // a finger that goes up or down scrolls the page
    controls.minAzimuthAngle = -ORBIT.azimuth;
    controls.maxAzimuthAngle = ORBIT.azimuth;
    controls.minPolarAngle = ORBIT.highest;
    controls.maxPolarAngle = ORBIT.lowest;
    controls.minDistance = ORBIT.nearest;
    controls.zoomToCursor = true;
    controls.addEventListener("change", () => {
      this.stayNear();
      this.redraw();
    });
    this.look();
  }

  /** Stand where all of the kitchen is in sight. */
  look() {
    const middle = new THREE.Vector3(...VIEW_MIDDLE);
    const back = new THREE.Vector3(...VIEW_FROM).normalize();
    const right = this.camera.up.clone().cross(back).normalize();
    const up = back.clone().cross(right);
    const tall = Math.tan((VIEW_ANGLE * Math.PI) / 360);
    const distances = IN_VIEW.map((corner) => {
      const offset = new THREE.Vector3(...corner).sub(middle);
      const across = Math.abs(offset.dot(right)) / (tall * this.camera.aspect);
      return offset.dot(back) + Math.max(across, Math.abs(offset.dot(up)) / tall);
    });
    const distance = 1.04 * Math.max(...distances);
    this.controls.maxDistance = 1.1 * distance;
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(back, distance);
    this.controls.update();
  }

  /** Whatever was zoomed to, turn round a point of the kitchen. */
  stayNear() {
    const { target } = this.controls;
    const [low, high] = LOOK_AT.map((corner) => new THREE.Vector3(...corner));
    const kept = target.clone().clamp(low, high);
    this.camera.position.add(kept).sub(target);
    target.copy(kept);
  }

  /** Keep to the element's size and to the page's theme. */
  follow() {
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(this.element);
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.onTheme = () => this.light();
    this.dark.addEventListener("change", this.onTheme);
    this.themes = new MutationObserver(this.onTheme);
    this.themes.observe(document.documentElement, { attributeFilter: ["data-theme"] });
    this.canvas.addEventListener("webglcontextrestored", () => this.redraw(true));
    this.onWheel = (event) => {
      if (!event.ctrlKey) event.stopPropagation(); // a plain wheel scrolls the page
    };
    this.element.addEventListener("wheel", this.onWheel, { capture: true });
    this.resize();
    this.light();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return; // the view is hidden
    if (this.width === width && this.height === height) return;
    [this.width, this.height] = [width, height];
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, FINEST));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.look();
    this.redraw();
  }

  light() {
    const { theme } = document.documentElement.dataset;
    const dark = theme ? theme === "dark" : this.dark.matches;
    const { wall, sky, ground, sun } = LIGHTS[dark ? "dark" : "light"];
    this.scene.background = new THREE.Color(wall);
    this.sky.color.set(sky[0]);
    this.sky.groundColor.set(ground);
    this.sky.intensity = sky[1];
    this.sun.color.set(sun[0]);
    this.sun.intensity = sun[1];
    this.redraw();
  }

  /** Draw before the browser shows its next frame; `moved` if shadows change. */
  redraw(moved = false) {
    if (moved) this.renderer.shadowMap.needsUpdate = true;
    this.frame ??= requestAnimationFrame((time) => {
      this.frame = null;
      if (this.beforeFrame(time)) this.redraw(true);
      this.renderer.render(this.scene, this.camera);
    });
  }

  dispose() {
    cancelAnimationFrame(this.frame);
    this.sizes.disconnect();
    this.themes.disconnect();
    this.dark.removeEventListener("change", this.onTheme);
    this.element.removeEventListener("wheel", this.onWheel, { capture: true });
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }
}
