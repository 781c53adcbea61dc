// What a picture of the inside of a cave is like, whoever has drawn it.

/// No rock has this colour: what shows it is a hole.
export const BACKGROUND = [255, 0, 255];

/// Mean brightness of what a WebGL context has drawn, how much it varies, and which share of it is background.
export function measure(gl) {
  const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let [sum, squares, holes] = [0, 0, 0];
  for (let i = 0; i < pixels.length; i += 4) {
    const [r, g, b] = pixels.subarray(i, i + 3);
    if (r === BACKGROUND[0] && g === BACKGROUND[1] && b === BACKGROUND[2]) holes += 1;
    const grey = (r + g + b) / 765;
    sum += grey;
    squares += grey * grey;
  }
  const count = pixels.length / 4;
  const mean = sum / count;
  return { mean, deviation: Math.sqrt(Math.max(0, squares / count - mean * mean)), background: holes / count };
}
