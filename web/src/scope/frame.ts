// A scope frame as the control sends it: the length of a header, the header, a column of f32 for each signal.
export interface Frame { rows: number; start_s: number; period_s: number; signals: string[]; lost_rows: number; columns: Float32Array[] }

export function frameOf(data: ArrayBuffer): Frame | null {
  if (data.byteLength < 4) return null;
  const length = new DataView(data).getUint32(0, true);
  if (length % 4 !== 0 || 4 + length > data.byteLength) return null;
  const text = new TextDecoder().decode(new Uint8Array(data, 4, length));
  const header = JSON.parse(text) as Omit<Frame, 'columns'>;
  const begin = 4 + length;
  if (begin + 4 * header.rows * header.signals.length > data.byteLength) return null;
  const columns = header.signals.map((_, index) => new Float32Array(data, begin + 4 * header.rows * index, header.rows));
  return { ...header, columns };
}
