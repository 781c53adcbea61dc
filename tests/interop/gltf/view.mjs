// What pages that draw a cave with three.js share: renderer, camera, exposure, and what the picture is like.
import * as THREE from 'three';
import { BACKGROUND, measure } from './pixels.mjs';

// Mean brightness that the camera aims at, and how far it opens for it. Tuned by eye: brighter, rock looks like plaster.
const [BRIGHTNESS, MOST_EXPOSURE] = [0.2, 5];

/// A renderer as large as the window, and a scene whose background is seen through holes only.
export function stage() {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setSize(innerWidth, innerHeight);
  renderer.toneMapping = THREE.ACESFilmicToneMapping;
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color().setRGB(...BACKGROUND.map((part) => part / 255), THREE.SRGBColorSpace);
  return { renderer, scene };
}

/// Draws twice: as a camera would, once the light has been measured. Gives what was measured.
export function expose(renderer, scene, camera) {
  renderer.render(scene, camera);
  const measured = measure(renderer.getContext());
  renderer.toneMappingExposure = Math.min(MOST_EXPOSURE, BRIGHTNESS / measured.mean);
  renderer.render(scene, camera);
  return measured;
}

/// A floor seen at a grazing angle is a blur without.
export function sharpen(scene, anisotropy) {
  scene.traverse(({ material }) => {
    for (const map of ['map', 'normalMap', 'roughnessMap', 'aoMap']) if (material?.[map]) material[map].anisotropy = anisotropy;
  });
}

/// At eye height over the spawn pose, looking along its +X and a little down; its +Z is up. The headlamp hangs beside
/// the eye: light from the eye itself shows no relief.
export function cameraAt(spawn, eye) {
  const turn = new THREE.Quaternion(...spawn.rotation);
  const at = (x, y, z) => new THREE.Vector3(x, y, z).applyQuaternion(turn).add(new THREE.Vector3(...spawn.position));
  const camera = new THREE.PerspectiveCamera(65, innerWidth / innerHeight, 0.05, 500);
  camera.position.copy(at(0, 0, eye));
  camera.up.copy(new THREE.Vector3(0, 0, 1).applyQuaternion(turn));
  camera.lookAt(at(3, 0, eye - 0.3));
  const headlamp = new THREE.PointLight(0xfff4e0, 9);
  headlamp.position.copy(at(0, 0.36, eye + 0.22));
  return [camera, headlamp];
}

export function trianglesOf({ geometry, isInstancedMesh, count }) {
  return (geometry.index ?? geometry.attributes.position).count / 3 * (isInstancedMesh ? count : 1);
}
