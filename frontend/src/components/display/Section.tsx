import { Text, Title } from "@mantine/core";
import type { ReactNode } from "react";

interface Props {
  title: string;
  note?: ReactNode;
  actions?: ReactNode;
  children: ReactNode;
}

/** Panel with a title. */
export function Section({ title, note, actions, children }: Props) {
  return (
    <section className="panel" style={{ padding: "12px 16px 16px" }} aria-label={title}>
      <div className="section-head">
        <div className="section-title">
          <Title order={2}>{title}</Title>
          {note !== undefined && (
            <Text size="xs" className="quiet">
              {note}
            </Text>
          )}
        </div>
        {actions}
      </div>
      {children}
    </section>
  );
}
