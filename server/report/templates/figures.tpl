{{%AUTOESCAPE context="HTML"}}
<section class="figures" aria-label="{{LABEL}}">
{{#FIGURE}}
<div class="card figure {{TONE}}">
<h2>{{NAME}}</h2>
<p class="value">{{VALUE}}</p>
{{#DETAIL}}<p class="hint">{{TEXT}}</p>{{/DETAIL}}
</div>
{{/FIGURE}}
</section>
