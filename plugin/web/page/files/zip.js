// Zip archives: entries that do not change are copied as they are packed.
import {FileError} from './mesh_file.js';

const kCrcTable = Uint32Array.from({length: 256}, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n;
});

function crcOf(bytes) {
  let crc = -1;
  for (const byte of bytes) crc = kCrcTable[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ -1) >>> 0;
}

const through = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

const kLarge = 0xffffffff;  // the number is in another field, of 64 bits

/** Where the list of entries begins, and how many there are. */
function listOf(bytes, view) {
  let end = bytes.length - 22;
  while (end >= 0 && view.getUint32(end, true) !== 0x06054b50) end--;
  if (end < 0) throw new FileError('this file is no zip archive: it is damaged, or was not wholly copied');
  const begin = view.getUint32(end + 16, true);
  if (begin !== kLarge) return [begin, view.getUint16(end + 10, true)];
  const record = Number(view.getBigUint64(end - 12, true));
  return [Number(view.getBigUint64(record + 48, true)), Number(view.getBigUint64(record + 32, true))];
}

/** Sizes and place of an entry, those of 64 bits from its extra field. */
function numbersOf(head) {
  const numbers = [24, 20, 42].map((at) => head.getUint32(at, true));  // unpacked, packed, place
  let at = 46 + head.getUint16(28, true);
  const end = at + head.getUint16(30, true);
  while (at + 4 <= end && head.getUint16(at, true) !== 1) at += 4 + head.getUint16(at + 2, true);
  at += 4;
  return numbers.map((number) => {
    if (number !== kLarge) return number;
    at += 8;
    return Number(head.getBigUint64(at - 8, true));
  });
}

/** The entries of an archive: {name, bytes()}, and what `repacked` takes over. */
export function entriesOf(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [begin, count] = listOf(bytes, view), entries = [];
  for (let i = 0, at = begin; i < count; i++) {
    const [nameLength, extra, comment] = [28, 30, 32].map((k) => view.getUint16(at + k, true));
    const head = bytes.slice(at, at + 46 + nameLength + extra + comment), method = view.getUint16(at + 10, true);
    const [size, packedSize, local] = numbersOf(new DataView(head.buffer));
    const data = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
    const packed = bytes.subarray(data, data + packedSize), name = head.subarray(46, 46 + nameLength);
    entries.push({
      name: new TextDecoder().decode(name), nameBytes: name, head, method, size, packed, crc: view.getUint32(at + 16, true),
      bytes: async () => (method === 0 ? packed : through(packed, new DecompressionStream('deflate-raw'))),
    });
    at += head.length;
  }
  return entries;
}

/** An archive of the same entries, some of them with new bytes: a map by name. */
export async function repacked(entries, changed) {
  const pieces = [], heads = [];
  let place = 0;
  for (const entry of entries) {
    let {method, size, packed, crc} = entry;
    if (changed.has(entry.name)) {
      const bytes = changed.get(entry.name);
      [method, size, crc] = [8, bytes.length, crcOf(bytes)];
      packed = await through(bytes, new CompressionStream('deflate-raw'));
    }
    const old = new DataView(entry.head.buffer), flags = old.getUint16(8, true) & ~8;  // sizes come before the data
    const fields = [[16, 20], [16, flags], [16, method], [32, old.getUint32(12, true)], [32, crc], [32, packed.length], [32, size], [16, entry.nameBytes.length]];
    const local = numbers([[32, 0x04034b50], ...fields, [16, 0]]);
    const more = [[16, 0], [16, 0], [16, 0], [16, old.getUint16(36, true)], [32, old.getUint32(38, true)], [32, place]];
    heads.push(numbers([[32, 0x02014b50], [16, old.getUint16(4, true)], ...fields, ...more]), entry.nameBytes);
    pieces.push(local, entry.nameBytes, packed);
    place += local.length + entry.nameBytes.length + packed.length;
  }
  const size = heads.reduce((sum, head) => sum + head.length, 0), count = [16, entries.length];
  const end = numbers([[32, 0x06054b50], [32, 0], count, count, [32, size], [32, place], [16, 0]]);
  return new Uint8Array(await new Blob([...pieces, ...heads, end]).arrayBuffer());
}

/** Numbers of 16 or 32 bits, one after the other: [bits, number]. */
function numbers(list) {
  const view = new DataView(new ArrayBuffer(list.reduce((sum, [bits]) => sum + bits / 8, 0)));
  let at = 0;
  for (const [bits, number] of list) {
    view[`setUint${bits}`](at, number, true);
    at += bits / 8;
  }
  return new Uint8Array(view.buffer);
}
