import { Button, Menu } from "@mantine/core";
import { address } from "../../api/client";

interface Props {
  path: string;
  query?: { aircraft_id: number };
}

/** Downloads of the events of decisions, as JSON or Markdown. */
export function AuditTrailMenu({ path, query }: Props) {
  return (
    <Menu position="bottom-end">
      <Menu.Target>
        <Button variant="default">Audit trail</Button>
      </Menu.Target>
      <Menu.Dropdown>
        {(["json", "markdown"] as const).map((format) => (
          <Menu.Item key={format} component="a" href={address(path, { ...query, format })} download>
            {format === "json" ? "JSON" : "Markdown"}
          </Menu.Item>
        ))}
      </Menu.Dropdown>
    </Menu>
  );
}
