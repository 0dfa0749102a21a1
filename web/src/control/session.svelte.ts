// Who this page is to the control.
class Session {
  name = $state('');
  role = $state<'operator' | 'viewer'>('operator');
}
export const session = new Session();
