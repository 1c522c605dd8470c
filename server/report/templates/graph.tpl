{{%AUTOESCAPE context="HTML"}}
<svg xmlns="http://www.w3.org/2000/svg" class="graph" viewBox="0 0 {{WIDTH}} {{HEIGHT}}" role="{{ROLE}}" aria-label="{{LABEL}}" font-family="system-ui, sans-serif">
{{#TRACE}}<path class="trace {{STATE}}" d="{{D}}" fill="none" stroke="{{STROKE}}" stroke-width="{{THICK}}" stroke-linecap="round"/>
{{/TRACE}}
{{#LINK}}
{{#JUMP}}<a href="#{{ANCHOR}}" aria-label="{{TITLE}}">{{/JUMP}}
<path class="link {{STATE}}" d="{{D}}" fill="none" stroke="{{STROKE}}" stroke-width="{{THICK}}"{{#DASHED}} stroke-dasharray="6 5"{{/DASHED}}><title>{{TITLE}}</title></path>
{{#JUMPED}}</a>{{/JUMPED}}
{{/LINK}}
{{#TAG}}<text class="tag {{STATE}}" x="{{X}}" y="{{Y}}" text-anchor="middle" dominant-baseline="central" font-size="12" fill="#333333" stroke="#ffffff" stroke-width="7" stroke-linejoin="round" paint-order="stroke">{{TEXT}}</text>
{{/TAG}}
{{#NODE}}
{{#HALO}}<circle class="halo" cx="{{X}}" cy="{{Y}}" r="{{R}}" fill="none" stroke="#2457a6" stroke-width="2"/>{{/HALO}}
<circle class="node {{STATE}}" cx="{{X}}" cy="{{Y}}" r="{{R}}" fill="{{FILL}}" stroke="#ffffff" stroke-width="{{RIM}}"><title>{{TITLE}}</title></circle>
{{#NAMED}}<text class="name {{STATE}}" x="{{X}}" y="{{Y}}" text-anchor="{{SIDE}}" dominant-baseline="central" font-size="14" fill="#1b2430">{{TEXT}}</text>{{/NAMED}}
{{/NODE}}
</svg>
