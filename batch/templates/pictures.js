// Pictures as 16-bit floats: unpacking what report_pictures.py packed, and turning it into bytes for the screen.

/** The bytes of base64 text that was deflated. */
async function inflate(text) {
  const packed = await fetch(`data:application/octet-stream;base64,${text}`);
  const stream = packed.body.pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * The bits of the 16-bit floats of a picture, red, green and blue of each pixel, as a Uint16Array.
 * A method's picture is stored as its difference from `reference`, the reference as that from the left neighbour.
 */
async function decodePicture(text, width, height, reference) {
  const bytes = await inflate(text);
  const count = width * height;
  const codes = new Uint16Array(3 * count);
  const folded = (at) => bytes[at] | (bytes[at + 3 * count] << 8) | (bytes[at + 6 * count] << 16);
  const signed = (at) => {
    const value = folded(at);
    return (value >> 1) ^ -(value & 1);
  };
  for (let pixel = 0, at = 0; pixel < count; pixel++, at += 3) {
    const green = signed(pixel);
    const difference = [green + signed(count + pixel), green, green + signed(2 * count + pixel)];
    const atRowStart = pixel % width === 0;
    for (let channel = 0; channel < 3; channel++) {
      const left = atRowStart ? 0 : codes[at + channel - 3];
      codes[at + channel] = difference[channel] + (reference ? reference[at + channel] : left);
    }
  }
  return codes;
}

/** The number whose 16-bit float has the bits `code`; `code` is never negative, infinite or no number. */
function halfValue(code) {
  const exponent = code >> 10;
  const fraction = code & 1023;
  return exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
}

/** For each bit pattern of a 16-bit float, what a screen shows, 0 to 255 (not rounded), `stops` brighter. */
function displayTable(stops) {
  const gain = 2 ** stops;
  return Float32Array.from({ length: 0x7c00 }, (_, code) => {
    const linear = Math.min(1, halfValue(code) * gain);
    return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
  });
}

/** A canvas of which `color(pixel, channel)` gives the bytes; they are rounded and clamped. */
function paint(width, height, color) {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  for (let pixel = 0, at = 0; pixel < width * height; pixel++, at += 4) {
    for (let channel = 0; channel < 3; channel++) image.data[at + channel] = color(pixel, channel);
    image.data[at + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** The colours of FLIP maps, three bytes each. */
const palette = Uint8Array.from(MAGMA.match(/../g), (digits) => parseInt(digits, 16));
