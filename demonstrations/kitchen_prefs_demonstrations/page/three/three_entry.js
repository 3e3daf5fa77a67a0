// What the page uses of three.js: esbuild makes three.min.js from this file, as the README says.
export {
  BoxGeometry, CircleGeometry, Color, DirectionalLight, HemisphereLight, InstancedMesh, Matrix4,
  Mesh, MeshBasicMaterial, PerspectiveCamera, PlaneGeometry, Quaternion, Raycaster,
  RepeatWrapping, Scene, SRGBColorSpace, Texture, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
export { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
