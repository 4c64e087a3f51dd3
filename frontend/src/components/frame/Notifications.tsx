import { Badge, Button, Group, Popover, Stack, Text, UnstyledButton } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useState } from "react";
import { useAnalyst } from "../../api/analyst";
import { useMarkSeen } from "../../api/commands";
import { notificationsQuery } from "../../api/queries";
import type { Notifications as NotificationLists } from "../../api/types";
import { dateTime } from "../../lib/text/format";

/** Decisions awaiting action of the analyst, and changes since the last visit. */
export function Notifications() {
  const name = useAnalyst();
  const notifications = useQuery(notificationsQuery(name));
  const seen = useMarkSeen();
  const [open, setOpen] = useState(false);
  if (name === "" || notifications.data === undefined) return null;
  const { waiting, changes } = notifications.data;
  const count = waiting.length + changes.length;
  const close = () => {
    setOpen(false);
  };
  return (
    <Popover opened={open} onChange={setOpen} position="bottom-end" width={420}>
      <Popover.Target>
        <UnstyledButton
          className="frame-find"
          data-testid="notifications"
          data-waiting={waiting.length}
          data-changes={changes.length}
          aria-label={`${waiting.length} waiting for you, ${changes.length} new`}
          onClick={() => {
            setOpen(!open);
          }}
        >
          {waiting.length > 0 ? `${waiting.length} waiting` : count > 0 ? "News" : "No news"}
          {changes.length > 0 && (
            <Badge size="sm" ml={6} circle={changes.length < 10} variant="filled">
              {changes.length}
            </Badge>
          )}
        </UnstyledButton>
      </Popover.Target>
      <Popover.Dropdown>
        <Stack gap="sm" mah={480} style={{ overflow: "auto" }}>
          <Waiting waiting={waiting} onFollow={close} />
          <Changes changes={changes} onFollow={close} />
          {changes.length > 0 && (
            <Button
              variant="default"
              onClick={() => {
                seen.mutate(undefined);
              }}
            >
              Mark all as read
            </Button>
          )}
        </Stack>
      </Popover.Dropdown>
    </Popover>
  );
}

function Waiting({
  waiting,
  onFollow,
}: Pick<NotificationLists, "waiting"> & { onFollow: () => void }) {
  return (
    <div>
      <Text fw={600} size="sm">
        Awaiting action
      </Text>
      {waiting.length === 0 && (
        <Text size="sm" className="quiet">
          {" "}
          None{" "}
        </Text>
      )}
      {waiting.map((one) => (
        <Group key={one.decision_id} gap={6} wrap="nowrap">
          <Text size="sm">{one.what === "revise" ? "Revise" : "Review"}</Text>
          <Link
            to="/decisions/$id"
            params={{ id: one.decision_id }}
            className="link"
            onClick={onFollow}
          >
            {one.title}
          </Link>
        </Group>
      ))}
    </div>
  );
}

const DONE: Record<string, string> = {
  approve: "approved",
  "request-changes": "requested changes to",
  reject: "rejected",
  commented: "commented on",
  adopted: "adopted as baseline",
  declined: "ended",
};

function Changes({
  changes,
  onFollow,
}: Pick<NotificationLists, "changes"> & { onFollow: () => void }) {
  return (
    <div>
      <Text fw={600} size="sm">
        New since last visit
      </Text>
      {changes.length === 0 && (
        <Text size="sm" className="quiet">
          {" "}
          None{" "}
        </Text>
      )}
      {changes.map((one) => (
        <div key={`${one.subject} ${one.id} ${one.number}`}>
          <Text size="sm">
            {one.author || "Unnamed analyst"}{" "}
            {one.subject === "structure" ? `saved ${one.what} of` : (DONE[one.what] ?? one.what)}{" "}
            <Link
              to={one.subject === "structure" ? "/model-structures/$id" : "/decisions/$id"}
              params={{ id: one.id }}
              className="link"
              onClick={onFollow}
            >
              {one.title}
            </Link>
          </Text>
          <Text size="xs" className="quiet" lineClamp={2}>
            {dateTime(one.at)} {one.text}
          </Text>
        </div>
      ))}
    </div>
  );
}
