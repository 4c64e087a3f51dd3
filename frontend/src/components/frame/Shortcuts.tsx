import { Kbd, Modal, Table } from "@mantine/core";
import { VIEWS } from "../../views";

const SHORTCUTS: readonly (readonly [readonly string[], string])[] = [
  [["Ctrl", "K"], "Find a page, maneuver, run or symbol"],
  [["?"], "Show these shortcuts"],
  [["/"], "Search in the list of the page"],
  [["Esc"], "Close a dialog or menu"],
  ...VIEWS.map((view) => [["g", view.key], `Open ${view.label}`] as const),
];

/** Table of keyboard shortcuts. */
export default function Shortcuts({ onClose }: { onClose: () => void }) {
  return (
    <Modal
      opened
      onClose={onClose}
      title="Keyboard shortcuts"
      closeButtonProps={{ "aria-label": "Close" }}
    >
      <Table data-testid="shortcuts">
        <Table.Tbody>
          {SHORTCUTS.map(([keys, what]) => (
            <Table.Tr key={what}>
              <Table.Td w={120}>
                {keys.map((key) => (
                  <Kbd key={key} mr={4}>
                    {key}
                  </Kbd>
                ))}
              </Table.Td>
              <Table.Td>{what}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Modal>
  );
}
