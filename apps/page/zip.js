// ZIP archives of files that are stored as they are (PKWARE's APPNOTE, 4.3).

const crcTable = Uint32Array.from({length: 256}, (_, byte) => {
  for (let bit = 0; bit < 8; ++bit) byte = byte & 1 ? (byte >>> 1) ^ 0xedb88320 : byte >>> 1;
  return byte;
});
function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = (crc >>> 8) ^ crcTable[(crc ^ byte) & 255];
  return ~crc >>> 0;
}
/** Bytes of numbers, the low ones first: [size in bytes, number] each. */
function littleEndian(...numbers) {
  return numbers.flatMap(([size, number]) => Array.from({length: size}, (_, i) => Math.floor(number / 256 ** i) & 255));
}

/** files: [{name, bytes}], names of plain letters. */
function zipArchive(files) {
  const version = [2, 10], none = [2, 0], date = [2, 33];  // 1 January 1980
  const parts = [], list = [];
  let at = 0;
  for (const {name, bytes} of files) {
    const letters = new TextEncoder().encode(name), size = [4, bytes.length];
    const told = [version, none, none, none, date, [4, crc32(bytes)], size, size, [2, letters.length], none];
    const head = Uint8Array.from(littleEndian([4, 0x04034b50], ...told));
    list.push(Uint8Array.from(littleEndian([4, 0x02014b50], version, ...told, none, none, none, [4, 0], [4, at])), letters);
    parts.push(head, letters, bytes);
    at += head.length + letters.length + bytes.length;
  }
  const listed = list.reduce((sum, {length}) => sum + length, 0), count = [2, files.length];
  const end = Uint8Array.from(littleEndian([4, 0x06054b50], none, none, count, count, [4, listed], [4, at], none));
  return new Blob([...parts, ...list, end], {type: "application/zip"});
}
