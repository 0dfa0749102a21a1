// The unit of a signal, by the end of its name: `X.setpoint_mm`, `sync_error_um`.
const units = ['mm', 'um', 'deg', 'rpm', 's', 'percent', 'n', 'nm'];

export function unitOf(name: string): string {
  const end = name.slice(name.lastIndexOf('_') + 1).toLowerCase();
  return units.includes(end) ? end : '';
}
