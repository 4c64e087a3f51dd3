import { Menu, UnstyledButton } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { setCampaign, useCampaign } from "../../api/analyst";
import { useLogOut } from "../../api/commands";
import { aircraftQuery } from "../../api/queries";
import type { Session } from "../../api/types";

/** Who is logged in, with the role in each campaign. */
export function AccountMenu({ session }: { session: Session }) {
  const logOut = useLogOut();
  const aircraft = useQuery(aircraftQuery);
  const selected = useCampaign();
  const all = aircraft.data ?? [];
  const roleIn = (id: number) =>
    session.roles.find((one) => one.aircraft_id === id)?.role ??
    session.roles.find((one) => one.aircraft_id === null)?.role;
  return (
    <Menu position="bottom-end" withinPortal>
      <Menu.Target>
        <UnstyledButton
          className="frame-find"
          data-testid="account"
          aria-label={`Logged in as ${session.name ?? ""}`}
        >
          {session.name}
        </UnstyledButton>
      </Menu.Target>
      <Menu.Dropdown>
        {all.length > 0 && (
          <Menu.Label>{all.length > 1 ? "Store new designs and views in" : "Campaign"}</Menu.Label>
        )}
        {all.map((one) => (
          <Menu.Item
            key={one.id}
            className="frame-item"
            data-current={(all.length > 1 && selected === String(one.id)) || undefined}
            onClick={() => {
              setCampaign(String(one.id));
            }}
          >
            {one.name}, {roleIn(one.id)}
          </Menu.Item>
        ))}
        {all.length > 0 && <Menu.Divider />}
        <Menu.Item component={Link} to="/account">
          Account
        </Menu.Item>
        <Menu.Item component={Link} to="/tokens">
          API tokens
        </Menu.Item>
        {(session.mode === "team" || session.has_provider) && (
          <Menu.Item
            data-testid="log-out"
            onClick={() => {
              logOut.mutate();
            }}
          >
            Log out
          </Menu.Item>
        )}
      </Menu.Dropdown>
    </Menu>
  );
}
