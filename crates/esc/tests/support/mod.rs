//! A master of a few lines: a datagram a frame, and mail.
use esc::{AlState, DatagramCommand, NetworkSegment, Passed, datagrams};

/// A segment and the time.
pub(crate) struct Bench {
    pub(crate) segment: NetworkSegment,
    pub(crate) now_ns: u64,
    counter: u8,
}

/// Mailboxes of devices that have them.
pub(crate) const OUT: u16 = 0x1000;
pub(crate) const IN: u16 = 0x1080;
const MAILBOX: u16 = 0x80;

impl Bench {
    pub(crate) fn new(devices: impl IntoIterator<Item = esc::Device>) -> Self {
        let mut bench =
            Self { segment: NetworkSegment::new(devices), now_ns: 1_000_000, counter: 0 };
        for at in 0..bench.segment.len() as u16 {
            let station = (0x1001 + at).to_le_bytes();
            let address = u32::from(0x0010_u16) << 16 | u32::from(at.wrapping_neg());
            assert_eq!(bench.send(DatagramCommand::Apwr, address, &station).1, 1);
        }
        bench
    }

    pub(crate) fn wait_us(&mut self, us: u64) {
        self.now_ns += us * 1_000;
        // a frame that does nothing lets the devices see the time
        self.send(DatagramCommand::Nop, 0, &[0]);
    }

    /// Sends a datagram; returns data and working counter.
    pub(crate) fn send(
        &mut self,
        command: DatagramCommand,
        address: u32,
        data: &[u8],
    ) -> (Vec<u8>, u16) {
        let mut frame = frame(&[(command, address, data.to_vec())]);
        self.now_ns += 10_000;
        assert!(matches!(self.segment.pass(&mut frame, self.now_ns), Passed::Back(_)));
        let mut answer = (Vec::new(), 0);
        datagrams(&mut frame, |d| answer = (d.data.to_vec(), d.working_counter()));
        answer
    }

    /// Reads of the first device's registers.
    pub(crate) fn read(&mut self, register: u16, length: usize) -> (Vec<u8>, u16) {
        self.read_of(0, register, length)
    }

    pub(crate) fn read_of(&mut self, device: u16, register: u16, length: usize) -> (Vec<u8>, u16) {
        let address = u32::from(register) << 16 | u32::from(0x1001 + device);
        self.send(DatagramCommand::Fprd, address, &vec![0; length])
    }

    pub(crate) fn write(&mut self, register: u16, data: &[u8]) -> u16 {
        self.write_to(0, register, data)
    }

    pub(crate) fn write_to(&mut self, device: u16, register: u16, data: &[u8]) -> u16 {
        let address = u32::from(register) << 16 | u32::from(0x1001 + device);
        self.send(DatagramCommand::Fpwr, address, data).1
    }

    /// Requests an AL state of the first device, and returns status and code when it is done.
    pub(crate) fn request(&mut self, control: u8) -> (u8, u16) {
        self.write(0x0120, &[control, 0]);
        self.wait_us(2_000);
        let status = self.read(0x0130, 6).0;
        (status[0], u16::from_le_bytes([status[4], status[5]]))
    }

    pub(crate) fn sync_manager(&mut self, i: u16, start: u16, length: u16, control: u8) {
        let [s, l] = [start, length].map(u16::to_le_bytes);
        self.write(0x0800 + 8 * i, &[0; 8]);
        let on = u8::from(length > 0);
        self.write(0x0800 + 8 * i, &[s[0], s[1], l[0], l[1], control, 0, on, 0]);
    }

    pub(crate) fn mailboxes(&mut self) {
        self.sync_manager(0, OUT, MAILBOX, 0x26);
        self.sync_manager(1, IN, MAILBOX, 0x22);
    }

    /// Brings the first device, a drive with its own PDOs, to a state.
    pub(crate) fn bring_to(&mut self, state: AlState) {
        self.mailboxes();
        assert_eq!(self.request(0x11), (1, 0));
        if state == AlState::Init {
            return;
        }
        assert_eq!(self.request(2), (2, 0));
        if state == AlState::PreOp {
            return;
        }
        self.process_data();
        assert_eq!(self.request(4), (4, 0));
        if state == AlState::SafeOp {
            return;
        }
        self.write(0x0120, &[8, 0]);
        self.outputs(0, 0);
        self.wait_us(2_000);
        assert_eq!(self.read(0x0130, 1).0, [8]);
    }

    pub(crate) fn process_data(&mut self) {
        self.sync_manager(2, 0x1100, 6, 0x64);
        self.sync_manager(3, 0x1700, 6, 0x20);
    }

    /// Sends control word and target to a drive with its own PDOs.
    pub(crate) fn outputs(&mut self, control: u16, target: i32) {
        let data = [&control.to_le_bytes()[..], &target.to_le_bytes()[..]].concat();
        assert_eq!(self.write(0x1100, &data), 1);
    }

    /// Sends mail to the first device and returns the body of its answer.
    pub(crate) fn mail(&mut self, kind: u8, body: &[u8]) -> Option<Vec<u8>> {
        self.counter = self.counter % 7 + 1;
        let mut mail = (body.len() as u16).to_le_bytes().to_vec();
        mail.extend([0, 0, 0, kind | self.counter << 4]);
        mail.extend(body);
        mail.resize(usize::from(MAILBOX), 0);
        assert_eq!(self.write(OUT, &mail), 1, "the mailbox takes mail");
        self.answer()
    }

    /// Waits for mail and returns its body.
    pub(crate) fn answer(&mut self) -> Option<Vec<u8>> {
        for _ in 0..10 {
            self.wait_us(100);
            if self.read(0x080D, 1).0[0] & 8 != 0 {
                let (mail, counter) = self.read(IN, usize::from(MAILBOX));
                assert_eq!(counter, 1);
                let length = usize::from(u16::from_le_bytes([mail[0], mail[1]]));
                return Some(mail[6..6 + length].to_vec());
            }
        }
        None
    }

    /// Asks the SDO server; returns what stands behind the CoE header.
    pub(crate) fn sdo(&mut self, request: &[u8]) -> Vec<u8> {
        let mut body = vec![0, 0x20];
        body.extend(request);
        self.mail(3, &body).expect("an answer")[2..].to_vec()
    }

    pub(crate) fn upload(&mut self, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
        self.upload_with(0x40, index, sub)
    }

    /// Uploads with a command: 50 is complete access.
    pub(crate) fn upload_with(&mut self, command: u8, index: u16, sub: u8) -> Result<Vec<u8>, u32> {
        let [i0, i1] = index.to_le_bytes();
        let answer = self.sdo(&[command, i0, i1, sub, 0, 0, 0, 0]);
        let four = u32::from_le_bytes(answer[4..8].try_into().unwrap());
        if answer[0] == 0x80 {
            return Err(four);
        }
        if answer[0] & 2 != 0 {
            let unused = usize::from(answer[0] >> 2 & 3);
            return Ok(answer[4..8 - unused].to_vec());
        }
        let mut data = answer[8..].to_vec();
        let mut toggle = 0;
        while data.len() < four as usize {
            let answer = self.sdo(&[0x60 | toggle, 0, 0, 0, 0, 0, 0, 0]);
            assert_eq!(answer[0] & 0xF0, toggle, "{answer:02X?}");
            let unused = if answer.len() == 8 { usize::from(answer[0] >> 1 & 7) } else { 0 };
            data.extend(&answer[1..answer.len() - unused]);
            assert_eq!(answer[0] & 1 == 1, data.len() == four as usize);
            toggle ^= 0x10;
        }
        Ok(data)
    }

    pub(crate) fn download(&mut self, index: u16, sub: u8, data: &[u8]) -> Result<(), u32> {
        let [i0, i1] = index.to_le_bytes();
        let unused = (4 - data.len()) as u8;
        let mut request = vec![0x23 | unused << 2, i0, i1, sub];
        request.extend(data);
        request.resize(8, 0);
        self.outcome(&request)
    }

    /// Downloads with the size, and in segments where it does not fit.
    pub(crate) fn download_with(
        &mut self,
        command: u8,
        index: u16,
        sub: u8,
        data: &[u8],
    ) -> Result<(), u32> {
        let [i0, i1] = index.to_le_bytes();
        let mut request = vec![command, i0, i1, sub];
        request.extend((data.len() as u32).to_le_bytes());
        let room = usize::from(MAILBOX) - 16;
        let (first, mut rest) = data.split_at(data.len().min(room));
        request.extend(first);
        self.outcome(&request)?;
        let mut toggle = 0;
        while !rest.is_empty() {
            let (part, after) = rest.split_at(rest.len().min(usize::from(MAILBOX) - 9));
            let unused = 7_usize.saturating_sub(part.len());
            let mut request = vec![toggle | (unused as u8) << 1 | u8::from(after.is_empty())];
            request.extend(part);
            request.resize(request.len() + unused, 0);
            self.outcome(&request)?;
            (rest, toggle) = (after, toggle ^ 0x10);
        }
        Ok(())
    }

    fn outcome(&mut self, request: &[u8]) -> Result<(), u32> {
        let answer = self.sdo(request);
        match answer[0] {
            0x80 => Err(u32::from_le_bytes(answer[4..8].try_into().unwrap())),
            _ => Ok(()),
        }
    }
}

/// Builds a frame of datagrams.
pub(crate) fn frame(list: &[(DatagramCommand, u32, Vec<u8>)]) -> Vec<u8> {
    let mut frame = esc::EMPTY_FRAME.to_vec();
    for (i, (command, address, data)) in list.iter().enumerate() {
        let more = if i + 1 < list.len() { 0x8000 } else { 0 };
        frame.extend([command.code(), i as u8]);
        frame.extend(address.to_le_bytes());
        frame.extend((data.len() as u16 | more).to_le_bytes());
        frame.extend([0, 0]);
        frame.extend(data);
        frame.extend([0, 0]);
    }
    let length = (frame.len() - 16) as u16 | 0x1000;
    frame[14..16].copy_from_slice(&length.to_le_bytes());
    frame
}
