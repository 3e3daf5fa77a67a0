// The kitchen from its glTF file, as kitchen_gltf.py wrote it; lengths in metres, z up.

/** Pictures within the file, decoded without an address: the page's policy allows no blob's. */
class EmbeddedTextures {
  constructor(parser) {
    this.name = "embedded textures";
    this.parser = parser;
  }

  async loadTexture(index) {
    const { images, textures } = this.parser.json;
    const { bufferView, mimeType } = images[textures[index].source];
    const bytes = await this.parser.getDependency("bufferView", bufferView);
    const image = await createImageBitmap(new Blob([bytes], { type: mimeType }));
    const texture = new THREE.Texture(image);
    texture.flipY = false;
    texture.wrapS = THREE.RepeatWrapping;
    texture.wrapT = THREE.RepeatWrapping;
    texture.anisotropy = 8;
    texture.needsUpdate = true;
    return texture;
  }
}

/** What of the file the view needs: the parts that move, dishes by category and placements. */
async function readKitchen3D(glb) {
  const loader = new THREE.GLTFLoader();
  loader.register((parser) => new EmbeddedTextures(parser));
  const { scenes } = await loader.parseAsync(glb, "");
  const [kitchen] = scenes[0].children;
  kitchen.quaternion.identity(); // z stays up, as in the kitchen's own measures
  const part = Object.fromEntries(kitchen.children.map((child) => [child.name, child]));
  scenes.forEach((scene) => scene.traverse(withShadow));
  [part.door, part.bottom, part.top].forEach(ownMaterials); // each lights up by itself
  return {
    kitchen,
    room: part.room,
    door: part.door,
    racks: { bottom: part.bottom, top: part.top },
    dishes: scenes[1].children, // one of each category
    sink: new THREE.Vector3(...kitchen.userData.sink),
    counter: kitchen.userData.counter,
    placements: kitchen.userData.placements.map(pose3D),
  };
}

/** Position and quaternion of seven numbers; the quaternion has w first. */
function pose3D([x, y, z, w, i, j, k]) {
  return { position: new THREE.Vector3(x, y, z), quaternion: new THREE.Quaternion(i, j, k, w) };
}

function withShadow(object) {
  if (!object.isMesh) return;
  object.castShadow = !object.material.transparent;
  object.receiveShadow = true;
}

function ownMaterials(object) {
  object.traverse((mesh) => {
    if (mesh.isMesh) mesh.material = mesh.material.clone();
  });
}

/** A dish of a category in the colour of its number. */
function newDish3D(template, number) {
  const dish = template.clone();
  const [red, green, blue, alpha] = template.userData.colours[number];
  ownMaterials(dish);
  dish.material.color.setRGB(red, green, blue, THREE.SRGBColorSpace);
  dish.material.opacity = alpha;
  return dish;
}
