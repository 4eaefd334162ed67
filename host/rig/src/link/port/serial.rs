//! Serial ports of this computer.

use std::io;
use std::time::Duration;

use serialport::{SerialPortType, UsbPortInfo};

use super::error::PortError;
use super::stream::Stream;

impl Stream for Box<dyn serialport::SerialPort> {
    fn set_wait(&mut self, wait: Duration) -> io::Result<()> {
        self.as_mut().set_timeout(wait).map_err(io::Error::from)
    }
}

/// Opens a serial port for raw bytes: 8 data bits, no parity, 1 stop bit, no flow control. Bytes from before are dropped.
pub(super) fn open(path: &str, baud: u32) -> io::Result<Box<dyn serialport::SerialPort>> {
    let port = serialport::new(path, baud).open()?;
    port.clear(serialport::ClearBuffer::Input)?;
    Ok(port)
}

/// A serial port that the operating system knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialPort {
    /// Name, as an address takes it.
    pub path: String,
    /// Device behind it, in words.
    pub description: String,
    /// Serial number of a USB device, if it has one.
    pub serial_number: Option<String>,
}

/// Serial ports of this computer, by name.
///
/// # Errors
/// [`PortError::List`].
pub fn serial_ports() -> Result<Vec<SerialPort>, PortError> {
    let found = serialport::available_ports().map_err(|error| PortError::List(error.into()))?;
    let mut ports: Vec<SerialPort> = found.into_iter().map(|port| named(port.port_name, &port.port_type)).collect();
    ports.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(ports)
}

fn named(path: String, kind: &SerialPortType) -> SerialPort {
    let (description, serial_number) = match kind {
        SerialPortType::UsbPort(usb) => (usb_name(usb), usb.serial_number.clone()),
        SerialPortType::PciPort => ("PCI".to_owned(), None),
        SerialPortType::BluetoothPort => ("Bluetooth".to_owned(), None),
        SerialPortType::Unknown => ("unknown".to_owned(), None),
    };
    SerialPort { path, description, serial_number }
}

fn usb_name(usb: &UsbPortInfo) -> String {
    let words = [usb.manufacturer.as_deref(), usb.product.as_deref()];
    let name: Vec<&str> = words.into_iter().flatten().collect();
    format!("USB {:04x}:{:04x} {}", usb.vid, usb.pid, name.join(" ")).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usb_devices_have_numbers_and_as_much_of_a_name_as_there_is() {
        let usb = |manufacturer: Option<&str>, product: Option<&str>| {
            SerialPortType::UsbPort(UsbPortInfo {
                vid: 0x0483,
                pid: 0x374b,
                serial_number: Some("0666".to_owned()),
                manufacturer: manufacturer.map(str::to_owned),
                product: product.map(str::to_owned),
            })
        };
        let port = named("COM3".to_owned(), &usb(Some("STMicroelectronics"), Some("STLink-V3")));
        assert_eq!(port.description, "USB 0483:374b STMicroelectronics STLink-V3");
        assert_eq!(port.serial_number.as_deref(), Some("0666"));
        assert_eq!(named("COM3".to_owned(), &usb(None, None)).description, "USB 0483:374b");
    }
}
